//! Output files: frames, diagnostics, states and a summary of each run of the program.
//!
//! Every file is first written under a hidden name in the same folder and then renamed. So it is complete or does not
//! exist, even if the program is killed or the disk is full. Equal input gives equal bytes, except for the times in
//! `run.json`.

mod atomic;
mod checkpoint;
mod diagnostics;
mod digest;
#[cfg(feature = "render")]
mod drawn;
mod error;
pub(crate) mod export;
mod extremes;
mod folder;
mod frame_folder;
mod frame_name;
#[cfg(feature = "render")]
mod frames;
mod lock;
mod png;
pub(crate) mod shell;
mod states;
mod summary;
mod timing;
mod whose;

pub use atomic::write_whole;
pub(crate) use atomic::{AtomicFile, folder_of};
pub(crate) use checkpoint::{Checkpoint, FramePictures, Manifest, waiting_states};
pub(crate) use diagnostics::{DIAGNOSTICS_FILE, DiagnosticsWriter};
pub(crate) use digest::{recorded, state_digest};
pub(crate) use error::OutputError;
pub use error::{is_folder, read_file};
pub(crate) use extremes::Extremes;
pub(crate) use folder::{Access, Claimed, Folder};
pub use frame_folder::FrameFolder;
pub(crate) use frame_name::FRAME_FILES;
pub(crate) use lock::FolderLock;
pub use png::{Compression, Shown, Tags, encode, encode_print, read_tags};
pub(crate) use states::{STATES_FILE, StatesWriter};
pub(crate) use summary::{Numbers, Outcome, RunEntry, RunStatus, SUMMARY_FILE, Summary, document};
pub use timing::{Clock, Spent, Timings, thread_time};
pub(crate) use whose::Whose;
#[cfg(feature = "render")]
pub(crate) use {
    checkpoint::passing_frames,
    drawn::{frame_files, is_drawn, packed, picture_size},
    frame_name::frame_file_name,
    frames::{FrameWriter, PixelFrame},
    png::Texts,
};

/// Rows of equal length as CSV (RFC 4180, with line feeds), quoted where necessary.
pub fn rows_as_csv(rows: impl IntoIterator<Item = impl IntoIterator<Item = impl AsRef<[u8]>>>) -> Vec<u8> {
    let mut table = csv::Writer::from_writer(Vec::new());
    rows.into_iter().for_each(|row| table.write_record(row).expect("rows of equal length into memory"));
    table.into_inner().expect("memory takes all")
}

/// A number with 17 significant digits, which identify a double precision number uniquely.
///
/// Not-a-number is `nan` and infinity `inf`, which most languages can parse.
pub fn exact(number: f64) -> String {
    if number.is_nan() { "nan".to_owned() } else { format!("{number:.16e}") }
}

#[cfg(test)]
mod tests {
    use super::exact;

    #[test]
    fn exact_numbers_survive_reading() {
        for number in [0.1, -1.0 / 3.0, 5e-324, f64::MAX, 0.0, 9.899495] {
            let text = exact(number);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
        }
        assert_eq!(exact(f64::NAN), "nan");
        assert_eq!(exact(f64::NEG_INFINITY), "-inf");
    }
}
