//! The contents of a mesh file in words and numbers, as `check` prints them.

use super::{CELLS, MeshFile, crossing, doubts, left, longest, mended, parts};
use crate::reading::beside::Wrong;
use crate::reading::captions;
use crate::reading::words::{count, list, quoted, several, short};
use crate::scene::file::FillKind;
use crate::scene::limits::Limits;
use crate::sim::geometry::{bounds, volumes_at_rest};
use crate::sim::{Body, Dimension};
use localshape_mesh::{Flaws, Group, Measures, Mesh, Surface, Volume, fill};
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// The contents of a mesh file. It prints as a short table. Lengths are in the unit of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct MeshSummary {
    /// Number of points.
    points: usize,
    /// Sides of the box around them.
    extent: [f64; 3],
    /// The parts of the file that are left out or not read, each as the predicate of a sentence about it.
    notes: Vec<String>,
    #[serde(flatten)]
    content: Content,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Content {
    Cells(CellsSummary),
    Surface(SurfaceSummary),
}

/// Cells, which become elements.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct CellsSummary {
    count: usize,
    /// Number of cells of each kind, such as `240 tetrahedra`.
    kinds: Vec<String>,
    /// The sum of their volumes, in the plane of their areas.
    volume: f64,
    /// The number of faces that are on the outside; `None` in the plane.
    outer_faces: Option<usize>,
    /// Number of cells that are turned inside out in the file.
    turned: usize,
    /// Number of parts that share no point.
    parts: usize,
    /// The value of `weld` that would join some of them.
    weld: Option<f64>,
    groups: Vec<GroupSummary>,
    /// Why they cannot be elements.
    #[serde(skip)]
    error: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct GroupSummary {
    name: String,
    /// Number of points.
    points: usize,
}

/// A surface, which is filled. Numbers are those of the mended surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct SurfaceSummary {
    triangles: usize,
    area: f64,
    /// The volume inside, if the surface is closed. Space in several shells counts once.
    volume: Option<f64>,
    closed: bool,
    #[serde(flatten, with = "FlawNames")]
    flaws: Flaws,
    /// The value of `weld` that would close at least half of the open edges.
    weld: Option<f64>,
    groups: Vec<GroupSummary>,
    /// The flaws that are left, or show in the elements of the first possible fill, with a remedy each.
    #[serde(rename = "flaws")]
    left: Vec<String>,
    /// The result of each fill.
    fills: Vec<FillSummary>,
}

/// The names of flaws in the document.
#[derive(Serialize)]
#[serde(remote = "Flaws")]
struct FlawNames {
    welded: usize,
    near: usize,
    degenerate: usize,
    doubled: usize,
    turned: usize,
    #[serde(rename = "open_edges")]
    boundary: usize,
    #[serde(rename = "edges_of_several")]
    non_manifold: usize,
    #[serde(rename = "inconsistent_edges")]
    inconsistent: usize,
    pieces: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct FillSummary {
    /// Its kind.
    with: FillKind,
    /// The side of its lattice.
    side: f64,
    elements: usize,
    nodes: usize,
    /// Number of parts that share no node.
    parts: usize,
    /// Why it is not possible.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

impl GroupSummary {
    fn new(group: &Group) -> Self {
        Self { name: group.name.clone(), points: group.points.len() }
    }
}

impl MeshSummary {
    /// Reads a file. A message is the predicate of a sentence about the file.
    pub(crate) fn read(path: &Path, limits: &Limits) -> Result<Self, Wrong> {
        let mesh = MeshFile::read(path, None, limits)?.mesh;
        let notes = mesh.notes().to_vec();
        let summary = match mesh {
            Mesh::Volume(volume) => Self::of_cells(volume)?,
            Mesh::Surface(surface) => Self::of_surface(&surface, limits),
        };
        Ok(Self { notes, ..summary })
    }

    fn of_cells(volume: Volume) -> Result<Self, Wrong> {
        let parts = parts(volume.points.len(), &volume.cells);
        let weld = if parts > 1 { volume.joining_weld() } else { None };
        let Volume { dimension, points, solids, cells, groups, turned, .. } = volume;
        let (low, high) = bounds(&points);
        let number = points.len();
        let body = Body::builder(points).dimension(dimension).elements(cells).solids(solids).build();
        let body = body.map_err(|error| (format!("has a mistake: {error}"), None))?;
        let of_kind = |(number, name): (usize, &str)| format!("{} {name}", count(number as u128));
        let content = Content::Cells(CellsSummary {
            count: body.elements().len(),
            kinds: captions::elements(&body).into_iter().map(of_kind).collect(),
            volume: volumes_at_rest(&body).iter().sum(),
            outer_faces: (dimension == Dimension::Space)
                .then(|| body.faces().outer.iter().filter(|outer| outer.is_none()).count()),
            turned,
            parts,
            weld,
            groups: groups.iter().map(GroupSummary::new).collect(),
            error: crossed(&body),
        });
        Ok(Self { points: number, extent: (high - low).to_array(), notes: Vec::new(), content })
    }

    fn of_surface(surface: &Surface, limits: &Limits) -> Self {
        let (surface, flaws) = surface.mended();
        let Measures { volume, area, closed, low, high, .. } = surface.measures();
        let longest = longest(&surface.points);
        let side = longest / f64::from(CELLS);
        let most = limits.of_mesh().points;
        let (mut overlap, mut of_cage) = (0.0, None);
        let fills = FillKind::ALL.map(|with| match fill(&surface, with.with_side(side), most) {
            Ok(filled) => {
                overlap = filled.cage.overlap.max(overlap);
                of_cage.get_or_insert_with(|| doubts(&filled.cage, volume, side, longest, false));
                let (elements, nodes) = (filled.cage.elements.len(), filled.cage.nodes.len());
                FillSummary { with, side, elements, nodes, parts: parts(nodes, &filled.cage.elements), error: None }
            }
            Err(error) => {
                let error = error.help.map_or(error.message.clone(), |help| format!("{}; {help}", error.message));
                FillSummary { with, side, elements: 0, nodes: 0, parts: 0, error: Some(error) }
            }
        });
        // Without any elements the fills say what is wrong.
        let told =
            left(&flaws, closed, None).filter(|_| of_cage.is_some()).into_iter().chain(of_cage.into_iter().flatten());
        let content = Content::Surface(SurfaceSummary {
            triangles: surface.triangles.len(),
            area,
            volume: closed.then_some(volume - overlap),
            closed,
            flaws,
            weld: surface.closing_weld(),
            groups: surface.groups.iter().map(GroupSummary::new).collect(),
            left: told.map(|(message, help)| format!("{message}; {help}")).collect(),
            fills: fills.into(),
        });
        Self { points: surface.points.len(), extent: (high - low).to_array(), notes: Vec::new(), content }
    }

    /// Why it cannot be a body; `None` if it can.
    pub(crate) fn fault(&self) -> Option<String> {
        match &self.content {
            Content::Surface(surface) if surface.fills.iter().all(|fill| fill.error.is_some()) => {
                surface.fills.first()?.error.clone()
            }
            Content::Surface(_) => None,
            Content::Cells(cells) => cells.error.clone(),
        }
    }
}

/// The fault of the first polygon whose sides cross.
fn crossed(body: &Body) -> Option<String> {
    body.elements().iter().zip(body.kinds()).enumerate().find_map(|(at, (nodes, &kind))| {
        let corners: Vec<_> = nodes.iter().map(|&node| body.rest()[node as usize]).collect();
        let [one, other] =
            crossing(kind, &corners)?.map(|corner| format!("{}–{}", nodes[corner], nodes[(corner + 1) % nodes.len()]));
        let help = "list its nodes in order around it, counter-clockwise";
        Some(format!("has a cell, elements[{at}], whose sides {one} and {other} cross; {help}"))
    })
}

impl fmt::Display for MeshSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: &str| writeln!(f, "  {name:<10} {text}");
        let sides: Vec<_> = self.extent.iter().map(|&side| short(side)).collect();
        let size = format!("{} in the unit of the file", sides.join(" × "));
        let points = several(self.points, "point");
        let in_parts =
            |parts: usize| if parts > 1 { format!(", {parts} parts that share no node") } else { String::new() };
        match &self.content {
            Content::Cells(cells) => {
                let kinds = list(&cells.kinds, "and", str::to_owned);
                line("cells", &format!("{points}, {kinds}{}", in_parts(cells.parts)))?;
                line("size", &size)?;
                let form = match cells.outer_faces {
                    Some(faces) => format!("volume {}, {}", short(cells.volume), several(faces, "outer face")),
                    None => format!("area {}", short(cells.volume)),
                };
                line("form", &form)?;
                if cells.turned > 0 {
                    line("mended", &format!("{} turned over, inside out in the file", several(cells.turned, "cell")))?;
                }
            }
            Content::Surface(surface) => {
                line("surface", &format!("{points}, {}", several(surface.triangles, "triangle")))?;
                line("size", &size)?;
                let measure = match surface.volume {
                    Some(volume) => format!("closed, volume {}", short(volume)),
                    None => "not closed".to_owned(),
                };
                let pieces = several(surface.flaws.pieces, "separate piece");
                line("form", &format!("{measure}, area {}, {pieces}", short(surface.area)))?;
                let mended = mended(&surface.flaws);
                if !mended.is_empty() {
                    line("mended", &list(&mended, "and", str::to_owned))?;
                }
                surface.left.iter().try_for_each(|flaw| line("flaw", flaw))?;
                for fill in &surface.fills {
                    let size = match &fill.error {
                        Some(error) => format!("none: the surface {error}"),
                        None => {
                            let [elements, nodes] = [fill.elements, fill.nodes].map(|number| count(number as u128));
                            let parts = in_parts(fill.parts);
                            format!(
                                "{elements} elements, {nodes} nodes{parts}, with {CELLS} cells of {}",
                                short(fill.side)
                            )
                        }
                    };
                    line(&captions::typed(&fill.with), &size)?;
                }
            }
        }
        self.notes.iter().try_for_each(|note| line("note", note))?;
        let (Content::Cells(CellsSummary { weld, groups, .. }) | Content::Surface(SurfaceSummary { weld, groups, .. })) =
            &self.content;
        if let Some(weld) = weld {
            line("remedy", &format!("weld = {} in `[body]`, times its `scale`, joins points", short(*weld)))?;
        }
        groups.iter().try_for_each(|group| {
            line("group", &format!("{}: {}", quoted(&group.name), several(group.points, "point")))
        })
    }
}
