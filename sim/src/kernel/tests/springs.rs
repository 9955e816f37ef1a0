//! The kernels for springs, in families and others.

use super::*;

/// Enough steps for a wrong term to exceed round-off, and for copies of the state in between.
const FEW: u64 = 200;

/// The kernel for families of springs, if there are families.
fn by_families(model: &MassSpring, body: &Body, conditions: &Conditions) -> Option<Box<dyn Stepper>> {
    let stencil = Stencil::new(&model.springs, [model.stiffness, model.damping], body, conditions)?;
    Some(Box::new(stencil))
}

/// The kernel for families of springs, if there are families, and the general one.
fn assert_springs_step_like_the_reference(body: &Arc<Body>, springs: &[[u32; 2]], damping: f64, families: bool) {
    let (start, model) = ((start(body, 6), Vec::new()), mass_spring(springs, damping));
    assert_eq!(by_families(&model, body, &conditions(SEMI, Set::best())).is_some(), families, "{springs:?}");
    for scheme in SCHEMES {
        let case = Case { body, start: &start, model: &model, scheme, steps: FEW };
        case.compare("gathered", Set::all(), &[1], |conditions| model.by_law(body, conditions, None).stepper);
        if families {
            let stencil = |conditions: &Conditions| by_families(&model, body, conditions).expect("families");
            case.compare("in families", Set::all(), &[1], stencil);
        }
    }
}

#[test]
fn springs_step_like_the_reference() {
    for damping in [0.0, 10.0] {
        for cells in [[3, 4, 2], [1, 1, 1], [7, 1, 3], [9, 5, 0]] {
            let body = whole(cells, 0.1, 16);
            for named in [Springs::Edges, Springs::EdgesOneDiagonal, Springs::All] {
                assert_springs_step_like_the_reference(&body, &body.topology().springs(named), damping, true);
            }
        }
        // All lengths equal; and one spring twice.
        let body = whole([4, 4, 4], 0.0, 17);
        let mut springs = body.topology().springs(Springs::EdgesFaceDiagonals);
        springs.push([springs[0][1], springs[0][0]]);
        assert_springs_step_like_the_reference(&body, &springs, damping, true);
        assert_springs_step_like_the_reference(&body, &[[9, 4]], damping, true);
        let random = &mut Noise(18);
        let mut springs: Vec<[u32; 2]> =
            (0..90).map(|_| [random.below(62) as u32, 62 + random.below(62) as u32]).collect();
        assert_springs_step_like_the_reference(&body, &springs, damping, false);
        // Of elements that are filled in part or differ in stiffness, and of none.
        springs.extend(body.topology().springs(Springs::All));
        for body in [filled(body.clone()), stiffened(body.clone()), filled(stiffened(body))] {
            assert_springs_step_like_the_reference(&body, &springs, damping, false);
        }
    }
}

#[test]
fn a_spring_between_coincident_nodes_does_nothing() {
    let body = whole([4, 1, 1], 0.0, 19);
    let springs = body.topology().springs(Springs::Edges);
    let model = mass_spring(&springs, 10.0);
    let start = (State::at_rest(vec![DVec3::ONE; body.len()]), Vec::new());
    for set in Set::all() {
        let free = conditions(SEMI, set);
        let stencil = by_families(&model, &body, &free).expect("a lattice");
        let kernel = model.by_law(&body, &free, None).stepper;
        for mut kernel in [Moving::new(stencil, &start, SEMI, 1), Moving::new(kernel, &start, SEMI, 1)] {
            assert_eq!(kernel.advance(9, Around { gravity: DVec3::ZERO, ..FREE }), Ok(()));
            assert_eq!(kernel.stored(&start), start);
        }
    }
}

/// Slabs, each with nodes that are moved after all others.
#[test]
fn springs_in_several_slabs_step_like_the_reference() {
    let body = whole([19, 19, 23], 0.1, 20);
    let springs = body.topology().springs(Springs::EdgesOneDiagonal);
    let (start, model) = ((start(&body, 7), Vec::new()), mass_spring(&springs, 10.0));
    let case = Case { body: &body, start: &start, model: &model, scheme: SEMI, steps: 50 };
    case.compare("slabs", Set::all().skip(1), &[1, 2, 3], |conditions| {
        by_families(&model, &body, conditions).expect("a lattice")
    });
}
