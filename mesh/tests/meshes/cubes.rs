//! Surfaces filled with cubes.

use crate::common::{apart, ball, block, ring, scan, together};
use glam::{DMat3, DQuat, DVec3};
use localshape_mesh::{Fill, Filled, Group, Surface, fill};

const MOST: usize = 1_000_000;

/// The volume of all filled parts.
fn filled_volume(filled: &Filled, side: f64) -> f64 {
    let count = filled.cage.elements.len();
    let parts = filled.cage.filled.clone().unwrap_or(vec![1.0; count]);
    assert_eq!(parts.len(), count);
    assert!(parts.iter().all(|&part| part > 0.0 && part <= 1.0));
    parts.iter().sum::<f64>() * side * side * side
}

/// Checks that every point follows the nodes of an element around it.
fn assert_carried(filled: &Filled) {
    let (low, high) = localshape_sim::geometry::bounds(&filled.cage.nodes);
    let size = (high - low).length() + low.abs().max(high.abs()).length();
    let affine = |point: DVec3| {
        let stretch = DMat3::from_cols_array(&[1.2, 0.3, -0.2, 0.1, 0.8, 0.4, -0.3, 0.2, 1.1]);
        stretch * point + DVec3::new(0.5, -0.3, 0.1) * size
    };
    let moved: Vec<_> = filled.cage.nodes.iter().map(|&node| affine(node)).collect();
    assert_eq!(filled.weights.len(), filled.surface.points.len());
    for (at, &point) in filled.surface.points.iter().enumerate() {
        let (nodes, weights) = filled.weights.of(at);
        assert!(!nodes.is_empty(), "point {at} at {point} is in no element");
        assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        let error = filled.weights.place(at, &moved).distance(affine(point));
        assert!(error < 1e-14 * size, "{error:e} of {size}");
    }
}

/// Checks that each point follows some nodes, wholly.
fn assert_followed(filled: &Filled) {
    assert_eq!(filled.weights.len(), filled.surface.points.len());
    for at in 0..filled.weights.len() {
        let (nodes, weights) = filled.weights.of(at);
        assert!(!nodes.is_empty());
        let size: f64 = weights.iter().map(|weight| weight.abs()).sum();
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12 * size, "{weights:?}");
    }
}

fn cubes(surface: &Surface, side: f64) -> Filled {
    let filled = fill(surface, Fill::Cubes { side }, MOST).unwrap();
    assert_carried(&filled);
    filled
}

/// Checks the sum of all filled parts against the divergence theorem.
fn assert_volume(filled: &Filled, side: f64) {
    let volume = filled.surface.measures().volume;
    let sum = filled_volume(filled, side);
    assert!((sum / volume - 1.0).abs() < 1e-9, "{sum} {volume}");
}

#[test]
fn a_block_is_filled_exactly() {
    for (low, size) in [(DVec3::ZERO, DVec3::new(0.6, 0.4, 0.3)), (DVec3::new(-0.7, 0.1, 3.3), DVec3::splat(0.7))] {
        let surface = block(low, low + size);
        let filled = cubes(&surface, 0.1);
        let counts = (size * 10.0).round();
        assert_eq!(filled.cage.elements.len() as f64, counts.element_product());
        assert_eq!(filled.cage.nodes.len() as f64, (counts + 1.0).element_product());
        assert_eq!(filled.cage.filled, None);
        assert!((filled.surface.measures().volume / size.element_product() - 1.0).abs() < 1e-14);
        // Nodes of an element: x fastest, then y, then z.
        let element = &filled.cage.elements[0];
        let at = |n: usize| filled.cage.nodes[element[n] as usize] - filled.cage.nodes[element[0] as usize];
        for (n, expected) in [(1, DVec3::X), (2, DVec3::Y), (4, DVec3::Z), (7, DVec3::ONE)] {
            assert!(at(n).distance(0.1 * expected) < 1e-14);
        }
    }
    // A block between planes of the lattice fills its outer cells in part.
    let filled = cubes(&block(DVec3::ZERO, DVec3::new(0.65, 0.65, 0.65)), 0.1);
    assert_eq!(filled.cage.elements.len(), 343);
    let least = filled.cage.filled.as_ref().unwrap().iter().copied().fold(1.0, f64::min);
    assert!((least - 0.75f64 * 0.75 * 0.75).abs() < 1e-12);
    assert_volume(&filled, 0.1);
}

#[test]
fn parts_add_up_to_the_volume() {
    let hollow = {
        let inner = ball(DVec3::splat(0.1), 0.5, 30);
        let turned = Surface { triangles: inner.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..inner };
        together(&[ball(DVec3::splat(0.1), 1.0, 60), turned])
    };
    for surface in [ball(DVec3::new(0.3, -0.2, 0.1), 1.0, 50), ring(1.0, 0.35, 80), hollow] {
        for side in [0.083, 0.25, 0.9, 5.0] {
            assert_volume(&cubes(&surface, side), side);
        }
    }
    // Steps at planes of the lattice leave no layer of empty cells, though their coordinates are rounded.
    let step = together(&[
        block(DVec3::ZERO, DVec3::new(0.9, 0.9, 0.3)),
        block(DVec3::new(0.0, 0.0, 0.3), DVec3::new(0.3, 0.9, 0.9)),
    ]);
    let single = Surface {
        points: step
            .points
            .iter()
            .map(|point| DVec3::from_array(point.to_array().map(|x| f64::from(x as f32))))
            .collect(),
        ..step
    };
    let filled = cubes(&single, 0.1);
    assert_eq!((filled.cage.elements.len(), filled.cage.filled), (9 * 9 * 3 + 3 * 9 * 6, None));
}

#[test]
fn a_cavity_stays_empty_and_pieces_in_each_other_are_one() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let hole = block(DVec3::splat(0.3), DVec3::splat(0.7));
    let turned = Surface { triangles: hole.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..hole.clone() };
    assert_eq!(cubes(&together(&[cube.clone(), turned]), 0.1).cage.elements.len(), 1000 - 64);
    let filled = cubes(&together(&[cube, hole]), 0.1);
    assert_eq!((filled.cage.elements.len(), filled.cage.filled), (1000, None));
}

/// How many bodies elements make that share nodes.
fn bodies(filled: &Filled) -> usize {
    let mut body: Vec<usize> = (0..filled.cage.nodes.len()).collect();
    loop {
        let mut changed = false;
        for element in filled.cage.elements.iter() {
            let least = element.iter().map(|&node| body[node as usize]).min().unwrap();
            for &node in element {
                changed |= std::mem::replace(&mut body[node as usize], least) != least;
            }
        }
        if !changed {
            break;
        }
    }
    body.iter().enumerate().filter(|(node, body)| node == *body).count()
}

#[test]
fn separate_parts_in_a_cube_do_not_grow_together() {
    // Two legs, in the same cubes for most of their length, that a beam joins above.
    let leg = |x: f64| block(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 0.13, 0.2, 1.0));
    let legs = together(&[leg(0.0), leg(0.15)]);
    let filled = cubes(&legs, 0.1);
    assert_eq!((filled.flaws.pieces, bodies(&filled)), (2, 2));
    assert_volume(&filled, 0.1);
    let single = cubes(&leg(0.0), 0.1).cage.elements.len();
    assert_eq!(filled.cage.elements.len(), 2 * single);
    // A horseshoe: its gap is thinner than a cube, and it is one body.
    let outline = [[0.0, 0.0], [0.43, 0.0], [0.43, 1.0], [0.23, 1.0], [0.23, 0.3], [0.2, 0.3], [0.2, 1.0], [0.0, 1.0]];
    let mut shoe = Surface::default();
    for y in [0.0, 0.3] {
        shoe.points.extend(outline.map(|[x, z]| DVec3::new(x, y, z)));
    }
    for n in 0..8 {
        let [a, b] = [n, (n + 1) % 8];
        shoe.triangles.extend([[a, b, b + 8], [a, b + 8, a + 8]]);
    }
    for [a, b, c] in [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [0, 5, 6], [0, 6, 7]] {
        shoe.triangles.extend([[c, b, a], [a + 8, b + 8, c + 8]]);
    }
    for side in [0.1, 0.083, 0.05] {
        let filled = cubes(&shoe, side);
        assert_eq!(filled.flaws.boundary, 0);
        assert_eq!(bodies(&filled), 1);
        assert_volume(&filled, side);
        // Pulled apart at the legs, no element spans the gap: the points of each leg share no node.
        let nodes = |left: bool| {
            let high = filled.surface.points.iter().enumerate().filter(|(_, at)| at.z > 0.9 && (at.x < 0.21) == left);
            let mut all: Vec<u32> = high.flat_map(|(point, _)| filled.weights.of(point).0.to_vec()).collect();
            all.sort_unstable();
            all
        };
        let (left, right) = (nodes(true), nodes(false));
        assert!(!left.is_empty() && left.iter().all(|node| right.binary_search(node).is_err()), "{side}");
    }
    // A plate, thinner than a cube and in any direction, stays in one piece: both of its sides are in the same copies.
    for turn in [DQuat::IDENTITY, DQuat::from_xyzw(0.3, -0.2, 0.4, 0.8).normalize()] {
        let plate = block(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.03));
        let plate = Surface { points: plate.points.iter().map(|&point| turn * point).collect(), ..plate };
        let filled = cubes(&plate, 0.1);
        let mut cells: Vec<_> = filled
            .cage
            .elements
            .iter()
            .map(|of| filled.cage.nodes[of[0] as usize].to_array().map(f64::to_bits))
            .collect();
        let all = cells.len();
        cells.sort_unstable();
        cells.dedup();
        println!("{all} copies of {} cubes", cells.len());
        assert_eq!(bodies(&filled), 1);
        assert_volume(&filled, 0.1);
    }
}

/// The volume of an element that is a cube with nodes in the middles of edges and faces.
fn volume_of(filled: &Filled, element: usize) -> f64 {
    let nodes: Vec<_> = filled.cage.elements[element].iter().map(|&node| filled.cage.nodes[node as usize]).collect();
    let (low, high) = localshape_sim::geometry::bounds(&nodes);
    (high - low).element_product()
}

#[test]
fn graded_cubes_are_coarse_inside() {
    for (surface, side) in [
        (block(DVec3::ZERO, DVec3::new(1.6, 1.6, 1.6)), 0.1),
        (ball(DVec3::ZERO, 1.0, 60), 0.06),
        (ring(1.0, 0.4, 80), 0.05),
    ] {
        let fine = cubes(&surface, side);
        let graded = fill(&surface, Fill::Graded { side }, MOST).unwrap();
        assert_carried(&graded);
        assert_eq!(graded.surface, fine.surface);
        let elements = &graded.cage.elements;
        println!("{} graded for {} cubes", elements.len(), fine.cage.elements.len());
        assert!(3 * elements.len() < 2 * fine.cage.elements.len());
        // They fill the same volume.
        let parts = |element: usize| graded.cage.filled.as_ref().map_or(1.0, |filled| filled[element]);
        let sum: f64 = (0..elements.len()).map(|element| parts(element) * volume_of(&graded, element)).sum();
        assert!((sum / filled_volume(&fine, side) - 1.0).abs() < 1e-12);
        assert_eq!(bodies(&graded), 1);
        // Each cube lists a node at all places of nodes on its surface.
        let mut places = graded.cage.nodes.clone();
        places.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
        places.dedup();
        let mut hanging = 0;
        for (element, nodes) in elements.iter().enumerate() {
            let at: Vec<_> = nodes.iter().map(|&node| graded.cage.nodes[node as usize]).collect();
            let (low, high) = localshape_sim::geometry::bounds(&at);
            let slack = 1e-9 * side;
            let inside = places.iter().filter(|node| node.cmpge(low - slack).all() && node.cmple(high + slack).all());
            assert_eq!(inside.count(), nodes.len(), "element {element}");
            for (n, place) in at.iter().take(8).enumerate() {
                let corner = DVec3::select(glam::BVec3::new(n & 1 > 0, n & 2 > 0, n & 4 > 0), high, low);
                assert!(place.distance(corner) < slack);
            }
            hanging += usize::from(nodes.len() > 8);
            assert!(nodes.len() <= 26);
        }
        assert!(hanging > 0);
        // The simulation takes their faces as those of cubes.
        let body = localshape_sim::Body::builder(graded.cage.nodes.clone())
            .elements(elements.clone())
            .build()
            .expect("a body");
        let topology = body.topology();
        for element in 0..elements.len() {
            let mut corners = Vec::new();
            topology.for_each_face(element, |face| corners.push(face.len()));
            assert_eq!(corners, [4; 6]);
        }
    }
    // Legs stay apart, and more elements than allowed are refused.
    let leg = |x: f64| block(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 0.63, 0.6, 1.0));
    let legs = fill(&together(&[leg(0.0), leg(0.65)]), Fill::Graded { side: 0.1 }, MOST).unwrap();
    assert_carried(&legs);
    assert_eq!(bodies(&legs), 2);
    let error = fill(&leg(0.0), Fill::Graded { side: 0.05 }, 500).unwrap_err();
    assert!(error.message.starts_with("needs "), "{error}");
    println!("{error} {:?}", error.help);
}

/// The mean square distance of a closed surface's inside from the origin: of tetrahedra between it and its triangles.
fn spread(surface: &Surface) -> f64 {
    let (mut sum, mut volume) = (0.0, 0.0);
    for of in &surface.triangles {
        let [a, b, c] = of.map(|point| surface.points[point as usize]);
        let own = a.dot(b.cross(c)) / 6.0;
        let all = a + b + c;
        sum += own * (all.length_squared() + a.length_squared() + b.length_squared() + c.length_squared()) / 20.0;
        volume += own;
    }
    sum / volume
}

/// The moment of inertia of a ball of graded cubes tends to the right one with the square of the side, as that of plain cubes does.
#[test]
fn moments_of_inertia_converge() {
    let surface = ball(DVec3::ZERO, 1.0, 96);
    let right = spread(&surface);
    let error = |with: Fill| {
        let filled = fill(&surface, with, MOST).unwrap();
        let (mut volumes, mut squares) = (vec![0.0; filled.cage.nodes.len()], 0.0);
        for (element, nodes) in filled.cage.elements.iter().enumerate() {
            let own = filled.cage.filled.as_ref().map_or(1.0, |parts| parts[element]) * volume_of(&filled, element);
            nodes.iter().for_each(|&node| volumes[node as usize] += own / nodes.len() as f64);
        }
        let all: f64 = volumes.iter().sum();
        let volumes = filled.cage.volumes.as_ref().unwrap_or(&volumes);
        let centre: DVec3 = filled.cage.nodes.iter().zip(volumes).map(|(&at, volume)| at * volume).sum();
        assert!((volumes.iter().sum::<f64>() / all - 1.0).abs() < 1e-12 && (centre / all).length() < 1e-4, "{centre}");
        filled.cage.nodes.iter().zip(volumes).for_each(|(at, volume)| squares += at.length_squared() * volume);
        squares / all / right - 1.0
    };
    for cells in [10.0, 20.0, 40.0, 80.0] {
        let side = 2.0 / cells;
        let [cubes, graded] = [Fill::Cubes { side }, Fill::Graded { side }].map(error);
        println!("{cells} cells: {cubes} {graded}");
        // The mass of cubes is in their corners, too far out. Graded ones are at most as wrong as cubes of twice the side.
        let square = side * side / right;
        assert!((cubes / square - 1.0).abs() < 0.01, "{cubes} with {cells} cells");
        assert!(graded > cubes && graded < 4.0 * square, "{graded} with {cells} cells");
    }
}

/// Graded cubes are of the material of plain ones: the same deformation of a block needs the same energy.
#[test]
fn coarse_cubes_are_as_stiff_as_the_fine_ones_in_their_place() {
    use localshape_sim::geometry::relative_stiffness;
    use localshape_sim::model::shape_based::ShapeBased;
    use localshape_sim::{Body, Integrator, State, Stepping, Surroundings, World};
    let energy = |with: Fill| {
        let cage = fill(&block(DVec3::ZERO, DVec3::splat(2.0)), with, MOST).unwrap().cage;
        let count = cage.nodes.len();
        let stretch = DMat3::from_cols_array(&[1.02, 0.03, 0.01, 0.03, 0.99, -0.02, 0.01, -0.02, 1.01]);
        let moved = cage.nodes.iter().map(|&node| stretch * node).collect();
        let body = Body::builder(cage.nodes).elements(cage.elements).build().expect("a body");
        let stiffness = relative_stiffness(&body, 0.1);
        let body = body.with_stiffness(stiffness).expect("one for each element");
        let model = ShapeBased::new(1.0);
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-4);
        let state = State::new(moved, vec![DVec3::ZERO; count]);
        World::new(&std::sync::Arc::new(body), state, &model, Surroundings::default(), stepping).diagnostics().elastic
    };
    let ratio = energy(Fill::Graded { side: 0.1 }) / energy(Fill::Cubes { side: 0.1 });
    println!("{ratio}");
    assert!((ratio - 1.0).abs() < 0.012, "{ratio}");
}

#[test]
fn open_surfaces_are_filled_to_the_hole() {
    let mut surface = ball(DVec3::ZERO, 1.0, 60);
    let whole = cubes(&surface, 0.1);
    // A hole of a tenth of the radius at a pole.
    surface.triangles.retain(|of| of.iter().any(|&point| surface.points[point as usize].z < 0.99));
    let open = cubes(&surface, 0.1);
    assert!(open.flaws.boundary > 20);
    let [whole, open] = [&whole, &open].map(|filled| filled_volume(filled, 0.1));
    assert!((open / whole - 1.0).abs() < 0.002, "{open} of {whole}");
    // Half a ball has an inside too: its opening hides half of the sphere from the points of the opening.
    surface.triangles.retain(|of| of.iter().all(|&point| surface.points[point as usize].z < 1e-9));
    let half = cubes(&surface, 0.1);
    let part = filled_volume(&half, 0.1) / whole;
    assert!((part - 0.5).abs() < 0.005, "{part}");
    assert_eq!(bodies(&half), 1);
}

/// Cells between the opening and the far end of an open block are filled as those of the closed one: what closes it bounds them, too.
#[test]
fn cells_behind_an_opening_are_filled_as_if_it_were_closed() {
    let closed = block(DVec3::ZERO, DVec3::new(1.0, 0.55, 0.35));
    for (axis, places) in [[2, 3], [6, 7], [10, 11]].into_iter().enumerate() {
        let mut open = closed.clone();
        open.triangles = (0..12).filter(|at| !places.contains(at)).map(|at| closed.triangles[at]).collect();
        let [all, some] = [&closed, &open].map(|surface| cubes(surface, 0.1));
        assert_eq!(some.flaws.boundary, 4);
        let part = |filled: &Filled, element: usize| filled.cage.filled.as_ref().map_or(1.0, |parts| parts[element]);
        let place = |filled: &Filled, element: usize| filled.cage.nodes[filled.cage.elements[element][0] as usize];
        let end = [0.6, 0.3, 0.1][axis];
        let mut compared = 0;
        for element in (0..all.cage.elements.len()).filter(|&element| place(&all, element)[axis] < end) {
            let at = place(&all, element);
            let same = (0..some.cage.elements.len()).find(|&other| place(&some, other).distance(at) < 1e-9).unwrap();
            assert!((part(&some, same) - part(&all, element)).abs() < 1e-9, "{at}");
            compared += usize::from(part(&all, element) < 1.0);
        }
        assert!(compared > 20);
    }
}

#[test]
fn what_cannot_be_filled_is_refused_with_a_remedy() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let error = |surface: &Surface, side, most| {
        let error = fill(surface, Fill::Cubes { side }, most).unwrap_err();
        format!("{error}; {}", error.help.as_ref().unwrap())
    };
    assert_eq!(
        error(&cube, 0.1, 900),
        "needs 1000 elements of side 0.1, and at most 900 are allowed; use a side of 0.12 or more, or allow more elements"
    );
    assert!(fill(&cube, Fill::Cubes { side: 0.12 }, 900).is_ok());
    assert!(error(&cube, 1e-9, 900).starts_with("needs about 1e27"), "{}", error(&cube, 1e-9, 900));
    assert!(error(&cube, 1e-300, 900).starts_with("needs about "));
    assert_eq!(error(&cube, 0.0, 9), "cannot be filled with elements of side 0; use a positive side");
    let tiny = Surface { points: cube.points.iter().map(|point| point * 1e-150).collect(), ..cube.clone() };
    assert!(error(&tiny, 1e-151, 900).starts_with("is 1e-150 long; expected 1e-50 to 1e50"));
    assert!(error(&cube, 1e200, 900).starts_with("is 1e0 long"), "{}", error(&cube, 1e200, 900));
    assert_eq!(error(&Surface::default(), 0.1, 9), "has no face with an area; use a file with faces");
    let sheet = Surface { triangles: cube.triangles[..2].to_vec(), ..cube.clone() };
    assert_eq!(
        error(&sheet, 0.1, 9000),
        "has no inside: it is open, 4 of its edges belong to one triangle only; give it a thickness, or close its holes, in \
         the program that made it"
    );
    // A thin rod across a large box.
    let rod =
        Surface { points: cube.points.iter().map(|point| point * 1e-3 + DVec3::splat(point.x)).collect(), ..cube };
    assert!(error(&rod, 1e-4, 1000).contains("at most 1000"));
}

#[test]
fn the_side_that_is_offered_fits() {
    let thin = block(DVec3::ZERO, DVec3::new(1.0, 0.7, 0.02));
    for surface in [block(DVec3::ZERO, DVec3::ONE), thin, ball(DVec3::ZERO, 1.0, 60), ring(1.0, 0.2, 60)] {
        for (side, most) in [(0.1, 100), (0.05, 300), (0.03, 2000), (0.02, 900), (0.001, 1000), (1e-7, 50)] {
            for is_graded in [false, true] {
                let with = |side| if is_graded { Fill::Graded { side } } else { Fill::Cubes { side } };
                let Err(error) = fill(&surface, with(side), most) else { continue };
                let help = error.help.clone().unwrap();
                let offered = help.strip_prefix("use a side of ").and_then(|rest| rest.split_once(" or more"));
                let offered: f64 = offered.unwrap_or_else(|| panic!("{error}: {help}")).0.parse().unwrap();
                let count = fill(&surface, with(offered), most).map(|filled| filled.cage.elements.len());
                println!("{error}; {offered}: {count:?}");
                assert!(count.unwrap() <= most);
            }
        }
    }
}

/// Few cubes hold a rod along the diagonal of a box, of which all cubes are visited.
#[test]
fn the_side_that_is_offered_has_few_places_in_its_box() {
    let mut rod = block(DVec3::new(0.0, -1e-3, -1e-3), DVec3::new(1.7, 1e-3, 1e-3));
    let turn = DQuat::from_rotation_arc(DVec3::X, DVec3::ONE.normalize());
    rod.points.iter_mut().for_each(|point| *point = turn * *point);
    let most = 60_000;
    let refused = fill(&rod, Fill::Cubes { side: 9e-4 }, most).unwrap_err();
    assert!(refused.message.ends_with("at most 60000 are allowed"), "{refused}");
    let side = refused.fitting.expect("a side");
    let filled = fill(&rod, Fill::Cubes { side }, most).unwrap_or_else(|error| panic!("{side}: {error}"));
    assert!((100..most).contains(&filled.cage.elements.len()), "{side}");
}

#[test]
fn large_triangles_are_divided_to_follow_the_elements() {
    let cube = block(DVec3::ZERO, DVec3::new(1.0, 0.5, 0.25));
    let filled = cubes(&cube, 0.1);
    let surface = &filled.surface;
    for of in &surface.triangles {
        for at in 0..3 {
            let [from, to] = [of[at], of[(at + 1) % 3]].map(|point| surface.points[point as usize]);
            assert!(from.distance(to) < 0.1 + 1e-6);
        }
    }
    let (measures, before) = (surface.measures(), cube.measures());
    assert!(measures.closed && measures.euler == 2);
    assert!((measures.volume - before.volume).abs() < 1e-6 && (measures.area - before.area).abs() < 1e-5);
    assert!(surface.triangles.len() < 2000, "{}", surface.triangles.len());
    // What is fine already stays as it is.
    let fine = ball(DVec3::ZERO, 1.0, 40).mended().0;
    assert_eq!(cubes(&fine, 0.3).surface.triangles, fine.triangles);
}

#[test]
fn scans_are_filled() {
    for name in ["armadillo.off", "elephant.off", "cheese.off", "bunny00.off"] {
        let Some(surface) = scan(name) else { return };
        let measures = surface.measures();
        let side = (measures.high - measures.low).max_element() / 30.0;
        let start = std::time::Instant::now();
        let filled = fill(&surface, Fill::Cubes { side }, MOST).unwrap();
        println!("{name}: {} cubes in {:?}, {:?}", filled.cage.elements.len(), start.elapsed(), filled.flaws);
        assert_carried(&filled);
        assert_eq!(bodies(&filled), 1);
        if filled.flaws.boundary == 0 {
            assert_volume(&filled, side);
        }
    }
    for name in ["ChineseDragon-10kv.off", "lion.off"] {
        let Some(surface) = scan(name) else { return };
        let measures = surface.measures();
        let side = (measures.high - measures.low).max_element() / 30.0;
        let start = std::time::Instant::now();
        let filled = fill(&surface, Fill::Cubes { side }, MOST).unwrap();
        println!("{name}: {} cubes in {:?}, {:?}", filled.cage.elements.len(), start.elapsed(), filled.flaws);
        println!("{} {}", filled_volume(&filled, side), measures.volume);
        assert_carried(&filled);
    }
}

#[test]
fn soups_of_triangles_are_filled_too() {
    let whole = ball(DVec3::ZERO, 1.0, 264);
    // Each triangle for itself, a little smaller.
    let mut soup = apart(&whole);
    for triangle in soup.points.chunks_mut(3) {
        let middle = triangle.iter().sum::<DVec3>() / 3.0;
        triangle.iter_mut().for_each(|point| *point = middle + (*point - middle) * 0.999);
    }
    let start = std::time::Instant::now();
    let filled = cubes(&soup, 0.06);
    println!("{} triangles in {:?}", soup.triangles.len(), start.elapsed());
    let (expected, found) = (whole.mended().0.measures().volume, filled_volume(&filled, 0.06));
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    assert_eq!(bodies(&filled), 1);
}

/// Cells of triangles that hang together with none hang together all the same, also where hardly a part of them is inside.
#[test]
fn cells_of_loose_triangles_hang_together() {
    let mut soup = apart(&ball(DVec3::ZERO, 1.0, 60));
    for triangle in soup.points.chunks_mut(3) {
        let middle = triangle.iter().sum::<DVec3>() / 3.0;
        triangle.iter_mut().for_each(|point| *point = middle + (*point - middle) * 0.7);
    }
    let filled = cubes(&soup, 0.15);
    assert_eq!(bodies(&filled), 1);
}

/// Whatever a surface is, it is filled or refused, and what is filled carries all points.
#[test]
fn any_triangles_are_filled_or_refused() {
    let mut state = 1u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u32
    };
    let (mut filled, mut refused) = (0, 0);
    for case in 0..200 {
        let count = 3 + next() % 12;
        // Coarse grids give equal points, triangles in planes of the lattice and triangles without area.
        let grid = [2, 3, 5, 1000][case % 4];
        let scale = [1.0, 1e-3, 1e3, 1e-150, 1e49, 1e300][case / 4 % 6];
        let odd = [f64::NAN, f64::INFINITY, -0.0, 1e308, f64::MIN_POSITIVE];
        let mut coordinate = || match next() % 200 {
            0 => odd[next() as usize % 5],
            _ => f64::from(next() % grid) / f64::from(grid - 1) * scale,
        };
        let points: Vec<_> = (0..count).map(|_| DVec3::new(coordinate(), coordinate(), coordinate())).collect();
        let number = next() % 40;
        let triangles =
            (0..number).map(|_| [0; 3].map(|_: u32| next() % (count + u32::from(case % 50 == 0)))).collect();
        let surface = Surface { points, triangles, ..Surface::default() };
        let side = scale * [0.1, 0.25, 0.5, 3.0][case / 24 % 4];
        for with in [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
            match fill(&surface, with, 2000) {
                Ok(of) => {
                    filled += 1;
                    match with {
                        Fill::Cubes { .. } | Fill::Graded { .. } => assert_carried(&of),
                        // Points outside of all elements follow the nearest with weights below zero.
                        _ => assert_followed(&of),
                    }
                    assert!(of.cage.elements.len() <= 2000);
                    assert!(of.cage.filled.iter().flatten().all(|&part| part > 0.0 && part <= 1.0));
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.help.is_some(), "{error}");
                }
            }
        }
    }
    assert!(filled > 50 && refused > 50, "{filled} {refused}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let mut surface = ball(DVec3::ZERO, 1.0, 60);
    surface.triangles.truncate(3000);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&surface, Fill::Cubes { side: 0.1 }, MOST).unwrap())
    };
    let one = run(1);
    assert_eq!(one, run(3));
    assert_eq!(one, run(8));
}

#[test]
fn groups_of_points_are_groups_of_the_nodes_that_carry_them() {
    let group = |name: &str, points: &[u32]| Group { name: name.to_owned(), points: points.to_vec() };
    let cube = block(DVec3::ZERO, DVec3::ONE);
    // Points of the face at z = 0, one corner, and a point that no triangle has.
    let groups = vec![group("foot", &[0, 1, 2, 3]), group("corner", &[7]), group("loose", &[8])];
    let points = cube.points.iter().copied().chain([DVec3::splat(2.0)]).collect();
    let surface = Surface { points, groups, ..cube };
    let side = 0.25;
    for with in [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
        let cage = fill(&surface, with, MOST).unwrap().cage;
        let names: Vec<_> = cage.groups.iter().map(|group| &*group.name).collect();
        assert_eq!(names, ["foot", "corner", "loose"]);
        assert!(cage.groups[2].points.is_empty());
        let places = |group: usize| cage.groups[group].points.iter().map(|&node| cage.nodes[node as usize]);
        // All nodes of the face, which is divided to follow them.
        let on_face = cage.nodes.iter().filter(|node| node.z == 0.0).count();
        assert!(places(0).all(|at| at.z == 0.0) && places(0).count() == on_face && on_face >= 25, "{with:?} {on_face}");
        assert_eq!(places(1).collect::<Vec<_>>(), [DVec3::ONE], "{with:?}");
    }
}

#[test]
fn far_too_many_elements_are_refused_in_words() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    for (with, words) in [
        (Fill::Cubes { side: 0.001 }, "needs about 1e9 elements of side 0.001, and at most 8.2 million are allowed"),
        (Fill::Tetrahedra { side: 1.0 / 150.0 }, "needs about 40 million elements of side 0.006667"),
    ] {
        let error = fill(&cube, with, 8_200_000).unwrap_err();
        println!("{error} {:?}", error.fitting);
        assert!(error.message.starts_with(words), "{error}");
    }
}
