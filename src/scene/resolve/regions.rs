//! Regions of bodies with a material of their own.

use super::choice::check_names;
use super::nodes::{Place, named_cells, round_off};
use super::table::BodyTable;
use crate::reading::collector::Here;
use crate::reading::words::quoted;
use crate::scene::file::{CellsFile, NodesFile};
use crate::scene::{Region, SceneBody};
use crate::sim::Body;
use crate::sim::geometry::volumes_at_rest;
use glam::DVec3;
use std::sync::Arc;

/// A body with the regions of its table, or `None` after reporting every mistake in them. The models of the body have these moduli, if they have
/// any.
pub(super) fn apply(table: &BodyTable<'_>, of: SceneBody, young: &[Option<f64>]) -> Option<SceneBody> {
    if table.file.region.is_empty() {
        return Some(of);
    }
    let before = table.here.report.total();
    let place = |at: usize| table.here.to("region").to(at);
    let named = table.file.region.iter().enumerate().map(|(at, typed)| (place(at), Some(&*typed.name)));
    check_names(["region", "regions"], named);
    let one = |(at, typed)| one(typed, &of, (table.file.density, young), &place(at));
    let regions: Vec<_> = table.file.region.iter().enumerate().map(one).collect();
    let regions: Vec<Region> = regions.into_iter().collect::<Option<_>>()?;
    let count = of.body.elements().len();
    let moduli = values(&regions, count, |region| region.modulus, table);
    let densities = values(&regions, count, |region| region.density, table);
    if table.here.report.total() > before {
        return None;
    }
    let mut body = Body::clone(&of.body);
    if let Some(moduli) = moduli {
        body = table.sound(body.with_modulus(moduli.into_iter().map(|one| one.unwrap_or(1.0)).collect()))?;
    }
    if let (Some(densities), Some(usual)) = (densities, table.file.density) {
        let masses = masses(&body, &densities.into_iter().map(|one| one.unwrap_or(usual) / usual).collect::<Vec<_>>());
        body = table.sound(body.with_masses(masses))?;
    }
    Some(SceneBody { body: Arc::new(body), regions, ..of })
}

/// A region of a body with this density whose models have these moduli.
fn one(
    typed: &CellsFile,
    of: &SceneBody,
    (density, young): (Option<f64>, &[Option<f64>]),
    here: &Here<'_>,
) -> Option<Region> {
    let before = here.report.total();
    let elements = cells(&typed.cells, of, &here.to("cells"));
    if typed.stiffness.is_none() && typed.young.is_none() && typed.density.is_none() {
        let message = format!("`{here}` is as the rest of the body: it has no `stiffness`, `young` or `density`");
        here.wrong(message, "such as stiffness = 20, a factor");
    }
    let modulus = typed.young.and_then(|own| {
        let first = young.first().copied().flatten();
        let Some(whole) = first.filter(|_| young.iter().all(|other| *other == first)) else {
            let here = here.to("young");
            let message =
                format!("`{here}` is a modulus, but not all models of the body have one and the same `young`");
            here.wrong_key(message, "write `stiffness`, a factor of the stiffness of any model");
            return None;
        };
        Some(own / whole)
    });
    if typed.density.is_some() && density.is_none() {
        let here = here.to("density");
        let message = format!("`{here}` needs the `density` of the rest of the body");
        here.wrong_key(message, "give the body a `density` in place of other masses");
    }
    let (elements, modulus) = (elements?, typed.stiffness.or(modulus));
    let region = Region { name: typed.name.clone(), elements, modulus, density: typed.density };
    (here.report.total() == before).then_some(region)
}

/// The cells that are chosen, in rising order.
fn cells(typed: &NodesFile, of: &SceneBody, here: &Here<'_>) -> Option<Vec<u32>> {
    let elements = of.body.elements();
    let found: Vec<u32> = match typed {
        NodesFile::List(list) => {
            if let Some((place, &cell)) = list.iter().enumerate().find(|(_, cell)| **cell as usize >= elements.len()) {
                let message =
                    format!("there is no cell {cell}; {} has cells 0 to {}", of.in_words(), elements.len() - 1);
                here.to(place).wrong(message, None);
                return None;
            }
            let mut list = list.clone();
            list.sort_unstable();
            list.dedup();
            list
        }
        NodesFile::Named(name) => named_cells(name, of, here)?,
        NodesFile::Region(region) => {
            let place = Place::new(region, of.body.dimension(), here)?;
            let close = round_off(&of.body);
            let middle = |nodes: &[u32]| {
                nodes.iter().map(|&node| of.initial.position[node as usize]).sum::<DVec3>() / nodes.len() as f64
            };
            (0..).zip(elements.iter()).filter(|(_, nodes)| place.has(middle(nodes), close)).map(|(at, _)| at).collect()
        }
    };
    if found.is_empty() {
        let message = format!("`{here}` takes no cell of {}", of.in_words());
        here.wrong(message, "`localshape check` prints where bodies start");
        return None;
    }
    Some(found)
}

/// A value of each of so many cells, where regions give one; `None` if none does. Reports a cell to which two regions give different values.
fn values(
    regions: &[Region],
    count: usize,
    of: impl Fn(&Region) -> Option<f64>,
    table: &BodyTable<'_>,
) -> Option<Vec<Option<f64>>> {
    let mut given: Vec<Option<(usize, f64)>> = vec![None; count];
    for (at, region, value) in regions.iter().enumerate().filter_map(|(at, one)| Some((at, one, of(one)?))) {
        let other = |&&cell: &&u32| given[cell as usize].is_some_and(|(_, other)| other != value);
        if let Some(&cell) = region.elements.iter().find(other) {
            let first = given[cell as usize].map_or(at, |(first, _)| first);
            let [one, two] = [first, at].map(|at| quoted(&regions[at].name));
            let message = format!("cell {cell} lies in the regions {one} and {two}, which give it different values");
            table.here.to("region").to(at).to("cells").wrong(message, "make one of them smaller");
        }
        region.elements.iter().for_each(|&cell| given[cell as usize] = Some((at, value)));
    }
    let values: Vec<_> = given.into_iter().map(|one| one.map(|(_, value)| value)).collect();
    values.iter().any(Option::is_some).then_some(values)
}

/// The masses of the nodes of a body (kg), whose elements have other densities, relative to that of the body.
fn masses(body: &Body, densities: &[f64]) -> Vec<f64> {
    let fill = |element: usize| body.fill().map_or(1.0, |fill| fill[element]);
    let mut sums = vec![[0.0; 2]; body.len()];
    for (element, (nodes, volume)) in body.elements().iter().zip(volumes_at_rest(body)).enumerate() {
        let volume = volume * fill(element) / nodes.len() as f64;
        nodes.iter().for_each(|&node| {
            let [usual, own] = &mut sums[node as usize];
            (*usual, *own) = (*usual + volume, *own + volume * densities[element]);
        });
    }
    let mass = |(mass, [usual, own]): (&f64, [f64; 2])| if own == usual { *mass } else { mass * (own / usual) };
    body.mass().iter().zip(sums).map(mass).collect()
}
