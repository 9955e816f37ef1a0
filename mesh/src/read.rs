//! Mesh files.
//!
//! Each format is one file, which makes [`Cells`] of bytes: points and cells as they are listed. [`Cells::mesh`] makes a [`Mesh`] of
//! them, in the same way for all formats. Numbers in a file are never trusted: lists grow as their entries are found.

mod abaqus;
mod arrays;
mod builder;
mod cells;
mod collapsed;
mod content;
mod copies;
mod gltf;
mod gmsh;
mod kinds;
mod medit;
mod meshing;
mod obj;
mod off;
mod order;
mod others;
mod ply;
mod polygon;
mod pvd;
mod source;
mod stl;
mod tags;
mod used;
mod vtk;
mod vtu;

pub use cells::{CellKind, Cells};
pub use others::converter;
pub use pvd::{Listed, read_list, read_pieces};
pub(crate) use used::Used;

use super::{Surface, Volume};

/// What a file contains.
#[derive(Clone, Debug, PartialEq)]
pub enum Mesh {
    /// Cells, which become elements.
    Volume(Volume),
    /// A surface, which is filled.
    Surface(Surface),
}

impl Mesh {
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::Volume(volume) => &volume.notes,
            Self::Surface(surface) => &surface.notes,
        }
    }
}

/// The format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront (`.obj`).
    Obj,
    /// Stereolithography (`.stl`), ASCII or binary.
    Stl,
    /// Stanford triangles (`.ply`), ASCII or binary.
    Ply,
    /// Object File Format (`.off`).
    Off,
    /// Khronos' transmission format 2.0 (`.gltf`, `.glb`), with its data inside or in files beside it.
    Gltf,
    /// Gmsh 2.2 or 4.1 (`.msh`), ASCII or binary.
    Gmsh,
    /// VTK's legacy format (`.vtk`), ASCII or binary.
    Vtk,
    /// VTK's unstructured grids and polygons in XML (`.vtu`, `.vtp`).
    Vtu,
    /// INRIA's Medit (`.mesh`) as text.
    Medit,
    /// Abaqus and CalculiX (`.inp`).
    Abaqus,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 10] = {
        use Format::*;
        [Obj, Stl, Ply, Off, Gltf, Gmsh, Vtk, Vtu, Medit, Abaqus]
    };

    /// The endings of its files, without the dot.
    pub fn endings(self) -> &'static [&'static str] {
        self.known().0
    }

    /// The endings of its files, and a file of it in words.
    fn known(self) -> (&'static [&'static str], &'static str) {
        match self {
            Self::Obj => (&["obj"], "an OBJ file"),
            Self::Stl => (&["stl"], "an STL file"),
            Self::Ply => (&["ply"], "a PLY file"),
            Self::Off => (&["off"], "an OFF file"),
            Self::Gltf => (&["gltf", "glb"], "a glTF file"),
            Self::Gmsh => (&["msh"], "a Gmsh file"),
            Self::Vtk => (&["vtk"], "a legacy VTK file"),
            Self::Vtu => (&["vtu", "vtp"], "a VTU file"),
            Self::Medit => (&["mesh"], "a Medit file"),
            Self::Abaqus => (&["inp"], "an Abaqus file"),
        }
    }

    /// The format of a file with this ending, in any case and without the dot.
    pub fn of(ending: &str) -> Option<Self> {
        let ending = ending.to_ascii_lowercase();
        Self::ALL.into_iter().find(|format| format.endings().contains(&&*ending))
    }
}

/// The largest mesh that is read.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The most points.
    pub points: usize,
    /// The most corners of all faces and cells.
    pub corners: usize,
}

/// Why a file was not read, as the predicate of a sentence about the file, and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct ReadError {
    /// What was found, and what was expected: “ends in line 7; expected a coordinate”.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl ReadError {
    fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { message: message.into(), help: Some(help.into()) }
    }

    fn damaged(message: impl Into<String>) -> Self {
        Self::new(message, source::DAMAGED)
    }
}

/// Gives the bytes of a file beside the one that is read, by its name: a relative path below the folder, with `/` between folders.
pub type Beside<'b> = dyn FnMut(&str) -> Result<Vec<u8>, ReadError> + 'b;

/// Reads a file without others beside it.
///
/// # Errors
/// If it is damaged, or larger than the limits, or has neither faces nor cells, or cells without area or volume.
pub fn read(bytes: &[u8], format: Format, limits: &Limits) -> Result<Mesh, ReadError> {
    read_cells(bytes, format, limits)?.mesh(format)
}

/// Reads the points and cells of a file as they are listed: in their order, unused and flat ones, too. Files of one mesh at
/// several moments then have the same points in the same places.
///
/// # Errors
/// If it is damaged, or larger than the limits.
pub fn read_cells(bytes: &[u8], format: Format, limits: &Limits) -> Result<Cells, ReadError> {
    read_cells_with(bytes, format, limits, &mut |_| Err(ReadError::new("is another file", "export all as one file")))
}

/// As [`read_cells`]. A glTF file may have its data in files beside it.
///
/// # Errors
/// If it is damaged, or larger than the limits, or a file beside it is not there.
pub fn read_cells_with(
    bytes: &[u8],
    format: Format,
    limits: &Limits,
    beside: &mut Beside<'_>,
) -> Result<Cells, ReadError> {
    // The first words of binary STL files may be anything.
    if format != Format::Stl || !stl::is_binary(bytes) {
        content::check(bytes, format)?;
    }
    match format {
        Format::Obj => obj::read(bytes, limits),
        Format::Stl => stl::read(bytes, limits),
        Format::Ply => ply::read(bytes, limits),
        Format::Off => off::read(bytes, limits),
        Format::Gmsh => gmsh::read(bytes, limits),
        Format::Gltf => gltf::read(bytes, limits, beside),
        Format::Vtk => vtk::read(bytes, limits),
        Format::Vtu => vtu::read(bytes, limits),
        Format::Medit => medit::read(bytes, limits),
        Format::Abaqus => abaqus::read(bytes, limits),
    }
}
