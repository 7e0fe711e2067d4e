//! JPEG. The encoder asks for rows while pictures in bands are pushed row by row, so that it works on a thread of its own there.

use super::{PictureFile, tiff};
use jpeg_encoder::{Encoder, EncodingError, ImageBuffer, JpegColorType, PixelDensity, rgb_to_ycbcr};
use std::cell::RefCell;
use std::io::{self, BufWriter, Write};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::thread;

/// Quality, 1..=100.
const QUALITY: u8 = 92;
/// Most bytes in a segment of a file.
const MOST_IN_SEGMENT: usize = 60_000;
/// Pieces that wait for the encoder.
const WAITING: usize = 2;
/// Encoded bytes that go to the file together.
const PIECE: usize = 1 << 16;
/// Whether pictures are written row by row: pages in a browser have no threads to spare.
pub(super) const HAS_ROWS: bool = cfg!(not(target_family = "wasm"));

/// Writes a picture whose pixels are in memory.
pub(super) fn encode(file: &PictureFile<'_>, out: &mut dyn Write) -> io::Result<()> {
    let [width, height] = size(file)?;
    encoder(file, out)?.encode(file.pixels, width, height, jpeg_encoder::ColorType::Rgb).map_err(failed)
}

/// Writes a picture row by row, see [`PictureFile::encode_rows`].
pub(super) fn encode_rows(
    file: &PictureFile<'_>,
    out: &mut dyn Write,
    rows: &dyn Fn(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let size = size(file)?;
    let (pixels, asked) = mpsc::sync_channel(WAITING);
    let (encoded, done) = mpsc::channel();
    thread::scope(|scope| {
        let work = move || {
            let source = Source { size, asked, rest: RefCell::default(), row: RefCell::new((None, Vec::new())) };
            let mut sink = BufWriter::with_capacity(PIECE, Sink(encoded));
            encoder(file, &mut sink)?.encode_image(source).map_err(failed)?;
            sink.flush()
        };
        let worker = thread::Builder::new().name("jpeg".into()).spawn_scoped(scope, work)?;
        let mut feed = Feed { pixels, done, out };
        let pushed = rows(&mut feed);
        let Feed { pixels, done, out } = feed;
        drop(pixels);
        let drained = pushed.and_then(|()| done.iter().try_for_each(|bytes: Vec<u8>| out.write_all(&bytes)));
        // A worker whose bytes nobody takes ends at its next ones.
        drop(done);
        let ended = worker.join().unwrap_or_else(|_| Err(io::Error::other("the encoder of JPEG failed")));
        drained.and(ended)
    })
}

fn size(file: &PictureFile<'_>) -> io::Result<[u16; 2]> {
    let side = |side: usize| {
        u16::try_from(side).map_err(|_| {
            let reason = format!("a JPEG has at most 65535 pixels along a side, not {side}; write a PNG or a TIFF");
            io::Error::new(io::ErrorKind::InvalidInput, reason)
        })
    };
    Ok([side(file.width)?, side(file.height)?])
}

/// An encoder with resolution and description.
fn encoder<W: Write>(file: &PictureFile<'_>, out: W) -> io::Result<Encoder<W>> {
    let mut encoder = Encoder::new(out, QUALITY);
    if let Some(dpi) = file.dpi {
        encoder.set_density(PixelDensity::dpi(dpi.round().clamp(1.0, 65_535.0) as u16));
    }
    // A comment is a segment of its own kind; readers show the description of EXIF instead.
    let mut words = file.words();
    words.truncate(words.floor_char_boundary(MOST_IN_SEGMENT));
    let exif = tiff::description_only(&words);
    encoder.add_exif_metadata(&exif).map_err(failed)?;
    Ok(encoder)
}

fn failed(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

/// Pixels on their way to the encoder, its bytes on their way to the file.
struct Feed<'a> {
    pixels: SyncSender<Vec<u8>>,
    done: Receiver<Vec<u8>>,
    out: &'a mut dyn Write,
}

impl Write for Feed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pixels.send(bytes.to_vec()).map_err(|_| io::Error::other("the encoder of JPEG has ended"))?;
        self.done.try_iter().try_for_each(|bytes| self.out.write_all(&bytes))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What the encoder writes.
struct Sink(Sender<Vec<u8>>);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.send(bytes.to_vec()).map_err(|_| io::ErrorKind::BrokenPipe)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The rows that the encoder asks for, from top to bottom, the last one several times.
struct Source {
    size: [u16; 2],
    asked: Receiver<Vec<u8>>,
    /// What has arrived and is not used, from an index on.
    rest: RefCell<(Vec<u8>, usize)>,
    /// Number and pixels of the row that was asked for last.
    row: RefCell<(Option<u16>, Vec<u8>)>,
}

impl Source {
    /// Fills a row; black where no more pixels arrive, in a file that is then given up.
    fn fill(&self, row: &mut Vec<u8>) {
        let length = 3 * usize::from(self.size[0]);
        row.clear();
        let (rest, used) = &mut *self.rest.borrow_mut();
        while row.len() < length {
            if *used == rest.len() {
                let Ok(next) = self.asked.recv() else { break };
                (*rest, *used) = (next, 0);
            }
            let take = (rest.len() - *used).min(length - row.len());
            row.extend_from_slice(&rest[*used..*used + take]);
            *used += take;
        }
        row.resize(length, 0);
    }
}

impl ImageBuffer for Source {
    fn get_jpeg_color_type(&self) -> JpegColorType {
        JpegColorType::Ycbcr
    }

    fn width(&self) -> u16 {
        self.size[0]
    }

    fn height(&self) -> u16 {
        self.size[1]
    }

    fn fill_buffers(&self, y: u16, buffers: &mut [Vec<u8>; 4]) {
        let (number, row) = &mut *self.row.borrow_mut();
        if *number != Some(y) {
            self.fill(row);
            *number = Some(y);
        }
        let [luma, blue, red, _] = buffers;
        for pixel in row.as_chunks::<3>().0 {
            let (y, b, r) = rgb_to_ycbcr(pixel[0], pixel[1], pixel[2]);
            luma.push(y);
            blue.push(b);
            red.push(r);
        }
    }
}
