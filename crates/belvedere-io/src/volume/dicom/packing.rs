//! Ways in which DICOM stores elements and pixels. Source: DICOM PS3.5 2024e, annex A, and PS3.6, annex A.

use super::data_set::Encoding;

/// How pixels are compressed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    RunLengths,
    Jpeg,
    /// Of a name that is not read.
    Other(String),
}

impl Packing {
    /// Of a transfer syntax, with the way in which its elements are stored.
    pub(super) fn of(syntax: &str) -> (Self, Encoding) {
        let little = Encoding { explicit: true, big_endian: false };
        let Some(kind) = syntax.strip_prefix("1.2.840.10008.1.2") else {
            return (Self::Other(format!("a private way ({syntax:.60})")), little);
        };
        let named = |name: &str| (Self::Other(name.to_owned()), little);
        match kind {
            "" => (Self::Plain, Encoding { explicit: false, big_endian: false }),
            ".1" | ".1.99" => (Self::Plain, little),
            ".2" => (Self::Plain, Encoding { explicit: true, big_endian: true }),
            ".5" => (Self::RunLengths, little),
            ".4.50" => (Self::Jpeg, little),
            ".4.51" => named("JPEG of 12 bits"),
            ".4.57" | ".4.70" => named("lossless JPEG"),
            ".4.80" | ".4.81" => named("JPEG-LS"),
            ".4.90" | ".4.91" | ".4.92" | ".4.93" => named("JPEG 2000"),
            ".4.110" | ".4.111" | ".4.112" => named("JPEG XL"),
            ".4.201" | ".4.202" | ".4.203" => named("High-Throughput JPEG 2000"),
            kind if kind.starts_with(".4.10") => named("a film (MPEG)"),
            other => named(&format!("an unknown way (1.2.840.10008.1.2{other:.40})")),
        }
    }

    /// Why pixels are not read.
    pub(super) fn refusal(&self) -> Option<String> {
        let Self::Other(name) = self else { return None };
        Some(format!(
            "its pixels are compressed as {name}, which is not read; uncompressed ones, run lengths and JPEG of 8 bits are: convert it, as with gdcmconv --raw or dcmdjpeg"
        ))
    }
}
