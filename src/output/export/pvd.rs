//! Lists of grids with their times, for ParaView.

use crate::reading::words::escaped;
use std::fmt::Write;

/// A list of grids of a run with a time step (s): the time (s), the name and the file of each.
pub(super) fn document(mark: &str, step: f64, files: impl Iterator<Item = (f64, String, String)>) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {mark} -->\n<!-- step {step} -->\n\
         <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n"
    );
    let (mut before, mut part) = (None, 0);
    for (time, name, file) in files {
        part = if before == Some(time) { part + 1 } else { 0 };
        before = Some(time);
        let name = if name.is_empty() { String::new() } else { format!(" name=\"{}\"", escaped(&name)) };
        let file = escaped(&file);
        writeln!(text, "<DataSet timestep=\"{time}\" group=\"\" part=\"{part}\"{name} file=\"{file}\"/>")
            .expect("writing to a string");
    }
    text + "</Collection>\n</VTKFile>\n"
}
