//! Header and variable length records.

/// Bytes of a header of version 1.0 to 1.2.
const SHORT: usize = 227;
/// Bytes of a header of version 1.4.
const LONG: usize = 375;
/// Most records that are looked at.
const MAX_RECORDS: u64 = 4096;

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    /// Where points begin.
    pub(super) start: usize,
    /// Format of the points, 0 to 10.
    pub(super) format: u8,
    pub(super) is_packed: bool,
    /// Bytes of a point.
    pub(super) record: usize,
    pub(super) count: u64,
    pub(super) scale: [f64; 3],
    pub(super) offset: [f64; 3],
    /// Where the content of each record lies: user, number, bytes.
    pub(super) records: Vec<(String, u16, std::ops::Range<usize>)>,
}

fn number(bytes: &[u8], at: usize, size: usize) -> Option<u64> {
    let bytes = bytes.get(at..at.checked_add(size)?)?;
    Some(bytes.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte)))
}

impl Header {
    pub(super) fn of(bytes: &[u8]) -> Result<Self, String> {
        if !bytes.starts_with(b"LASF") {
            return Err("it does not begin with LASF; it is no LAS or LAZ".into());
        }
        let cut = || format!("it has {} bytes and ends within its header; it is cut off", bytes.len());
        let at = |at: usize, size: usize| number(bytes, at, size).ok_or_else(cut);
        at(SHORT - 1, 1)?;
        let minor = at(25, 1)?;
        if at(24, 1)? != 1 || minor > 4 {
            return Err(format!(
                "its version is {}.{minor}, 1.0 to 1.4 are read; write it anew, as with pdal",
                at(24, 1)?
            ));
        }
        let real = |place: usize| Ok::<_, String>(f64::from_bits(at(place, 8)?));
        let reals = |place: usize| Ok::<_, String>([real(place)?, real(place + 8)?, real(place + 16)?]);
        let (scale, offset) = (reals(131)?, reals(155)?);
        let usable = scale.iter().all(|s| s.is_finite() && *s != 0.0) && offset.iter().all(|o| o.is_finite());
        if !usable {
            return Err(format!("its scale {scale:?} and offset {offset:?} give no places; it is damaged"));
        }
        let is_long = minor == 4 && bytes.len() >= LONG;
        let legacy = at(107, 4)?;
        let count = if is_long { at(247, 8)? } else { legacy };
        let count = if count == 0 { legacy } else { count };
        let kind = at(104, 1)? as u8;
        let (format, is_packed) = (kind & 0x3f, kind & 0xc0 != 0);
        let record = at(105, 2)? as usize;
        let least = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67].get(usize::from(format));
        let least =
            *least.ok_or_else(|| format!("its points have format {format}, 0 to 10 are read; it is damaged"))?;
        if record < least {
            return Err(format!(
                "its points of format {format} have {record} bytes, {least} are needed; it is damaged"
            ));
        }
        let start = at(96, 4)? as usize;
        if start > bytes.len() || start < SHORT {
            let has = bytes.len();
            return Err(format!("its points begin at byte {start}, the file has {has}; it is cut off, or damaged"));
        }
        let there = ((bytes.len() - start) / record) as u64;
        if count == 0 {
            return Err("it has no points; get it again".into());
        }
        if !is_packed && there < count {
            return Err(format!("it declares {count} points and holds {there}; it is cut off, get it again"));
        }
        let mut out = Self { start, format, is_packed, record, count, scale, offset, records: Vec::new() };
        out.add_records(bytes, at(94, 2)?, at(100, 4)?, false);
        if is_long {
            out.add_records(bytes, at(235, 8)?, at(243, 4)?, true);
        }
        Ok(out)
    }

    /// Adds records from a place on, up to the first that does not fit.
    fn add_records(&mut self, bytes: &[u8], place: u64, count: u64, extended: bool) {
        let (size, head) = if extended { (8, 60) } else { (2, 54) };
        let Ok(mut at) = usize::try_from(place) else { return };
        for _ in 0..count.min(MAX_RECORDS) {
            let user = at.checked_add(2).and_then(|from| bytes.get(from..from.checked_add(16)?));
            let length = number(bytes, at.saturating_add(20), size).and_then(|n| usize::try_from(n).ok());
            let (Some(user), Some(length), Some(id)) = (user, length, number(bytes, at.saturating_add(18), 2)) else {
                return;
            };
            let start = at + head;
            let Some(end) = start.checked_add(length).filter(|end| *end <= bytes.len()) else { return };
            let user = String::from_utf8_lossy(user).trim_matches('\0').to_owned();
            self.records.push((user, id as u16, start..end));
            at = end;
        }
    }

    /// Content of a record.
    pub(super) fn record_of<'b>(&self, bytes: &'b [u8], user: &str, number: u16) -> Option<&'b [u8]> {
        let found = self.records.iter().find(|(of, n, _)| of == user && *n == number)?;
        bytes.get(found.2.clone())
    }
}
