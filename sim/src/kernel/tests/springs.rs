//! The kernels for springs, in families and others.

use super::*;

/// Enough steps for a wrong term to exceed round-off, and for copies of the state in between.
const FEW: u64 = 200;

/// The kernel for families of springs, if there are families, and the general one.
fn assert_springs_step_like_the_reference(body: &Arc<Body>, springs: &[[u32; 2]], damping: f64, families: bool) {
    let start = start(body, 6);
    let model = MassSpring { stiffness: STIFFNESS, damping, springs: springs.into(), breaks_at: None };
    for scheme in [Scheme::SemiImplicitEuler, Scheme::ExplicitEuler, Scheme::VelocityVerlet, PEFRL] {
        let mut world = reference(body, &start, &model, scheme, Vec::new());
        world.advance(FEW);
        let [by_families, gathered] = same(Set::all(), &[1], |set, _| {
            let conditions = conditions(scheme, set);
            let stencil = Stencil::new(&model.springs, [model.stiffness, model.damping], body, &conditions);
            assert_eq!(stencil.is_some(), families, "{} springs", springs.len());
            let whole = (start.clone(), Vec::new());
            let run = |kernel: Moving| {
                let mut kernel = kernel;
                assert_eq!(kernel.advance(FEW, FREE), Ok(()));
                kernel.stored(&whole).0
            };
            let stencil = stencil.map(|stencil| -> Box<dyn Stepper> { Box::new(stencil) });
            let kernels = [stencil, Some(model.by_law(body, &conditions, None).stepper)];
            kernels.map(|kernel| kernel.map(|kernel| run(Moving::new(kernel, &whole, scheme, 1))))
        });
        for found in [by_families, gathered].iter().flatten() {
            let far = distance(found, world.state());
            assert!(far <= 1e-12, "{} springs, {scheme:?}: {far:e}", springs.len());
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
    let model = MassSpring { stiffness: STIFFNESS, damping: 10.0, springs: springs.into(), breaks_at: None };
    let start = State::at_rest(vec![DVec3::ONE; body.len()]);
    for set in Set::all() {
        let free = conditions(SEMI, set);
        let start = (start.clone(), Vec::new());
        let stencil =
            Box::new(Stencil::new(&model.springs, [model.stiffness, model.damping], &body, &free).expect("a lattice"));
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
    let start = start(&body, 7);
    let model = MassSpring { stiffness: STIFFNESS, damping: 10.0, springs: springs[..].into(), breaks_at: None };
    let mut world = reference(&body, &start, &model, Scheme::SemiImplicitEuler, Vec::new());
    world.advance(50);
    let found = same(Set::all().skip(1), &[1, 2, 3], |set, threads| {
        let stencil = Box::new(
            Stencil::new(&model.springs, [model.stiffness, model.damping], &body, &conditions(SEMI, set))
                .expect("a lattice"),
        );
        let whole = (start.clone(), Vec::new());
        let mut kernel = Moving::new(stencil, &whole, SEMI, threads);
        assert_eq!(kernel.advance(50, FREE), Ok(()));
        kernel.stored(&whole).0
    });
    let far = distance(&found, world.state());
    assert!(far <= 1e-12, "{far:e}");
}
