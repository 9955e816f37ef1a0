use super::*;

fn small() -> Stability {
    let text = "
        gravity = [0, -9.8, 0]
        time.duration = 2.5
        body = { lattice = { cells = [1, 1, 1], side = 0.1 }, velocity = [0, -3, 0] }
        obstacle = [{ kind = 'floor' }]
        run = [
            { name = 'shape', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 } },
            { name = 'springs', integrator = 'backward-euler', model = { kind = 'mass-spring', stiffness = 1e4 } },
            { name = 'own', integrator = 'dormand-prince', tolerance = 1e-6, model = { kind = 'shape-based', stiffness = 1 } },
        ]";
    Stability {
        scene: built_in(text, "small"),
        stiffnesses: vec![0.25, 4.0],
        shares: vec![0.3, 0.9, 1.1],
        speeds: vec![1.0],
        dampings: vec![1.0],
    }
}

#[test]
fn steps_below_the_limit_are_stable_and_steps_above_are_not() {
    let study = small();
    let results = measure(&study, &|_| true).expect("it is never stopped");
    assert_eq!(results.cells.len() as u64, study.work());
    assert!(results.text().ends_with("\nown chooses its own steps and is left out.\n"));
    for cell in results.cells.iter().filter(|cell| cell.run == 0) {
        assert_eq!(cell.turned_over.is_none(), cell.share > 1.0, "{cell:?}");
    }
    // Four times the stiffness, half the step.
    assert_eq!(results.cells[0].step, 4.0 * results.cells[3].step);
    assert_eq!((results.axes[1].limit, results.axes[1].stretched), (None, None));
    assert!(results.cells.iter().all(|cell| cell.run == 0 || cell.turned_over.is_some()));
}

#[test]
fn columns_are_documented() {
    let results = measure(&small(), &|_| true).expect("it is never stopped");
    assert_eq!(results.table().heads, crate::reading::documented("stability.csv"));
    assert_eq!(results.table().rows.len(), results.cells.len());
}

/// All rows up to the largest good share are good. A bad cell in any column excludes its row.
#[test]
fn the_largest_share_is_below_every_bad_cell() {
    let mut results = measure(&small(), &|_| true).expect("it is never stopped");
    let counts = [
        // Rows with shares .3, .9 and 1.1, column by column.
        [Some(0), Some(0), None],
        [Some(0), Some(1), Some(0)],
    ];
    results.cells.iter_mut().zip(counts.as_flattened()).for_each(|(cell, &count)| cell.turned_over = count);
    let axes = &results.axes[0];
    assert_eq!(results.up_to(axes, 1.0, |turned_over| turned_over.is_some()), 0.9);
    assert_eq!(results.up_to(axes, 1.0, |turned_over| turned_over == Some(0)), 0.3);
    assert_eq!(results.up_to(axes, 1.0, |_| true), 1.1);
    assert_eq!(results.up_to(axes, 1.0, |_| false), 0.0);
}

/// Impacts are twice as fast after a fall with four times the gravity.
#[test]
fn faster_impacts_have_more_gravity() {
    let text = |gravity: f64| {
        format!(
            "gravity = [0, -{gravity}, 0]
            time.duration = 3
            body = {{ lattice = {{ cells = [3, 3, 3], side = 0.1 }}, lowest = 5, rotation = {{ axis = [1, 0, 1], angle = 0.028284 }} }}
            obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3 }}]
            run = [{{ name = 'springs', model = {{ kind = 'mass-spring', stiffness = 1e3, damping_ratio = 0.1, springs = 'edges+one-diagonal' }} }}]"
        )
    };
    let outcomes = |gravity: f64, speed: f64| {
        let scene = built_in(&text(gravity), "fall");
        let stiffnesses = vec![1.0, 2.0, 4.0, 8.0];
        let study = Stability { scene, stiffnesses, shares: vec![0.3], speeds: vec![speed], dampings: vec![1.0] };
        let results = measure(&study, &|_| true).expect("it is never stopped");
        results.cells.into_iter().map(|cell| cell.turned_over).collect::<Vec<_>>()
    };
    let twice = outcomes(5.0, 2.0);
    assert_eq!(twice, outcomes(20.0, 1.0));
    assert_ne!(twice, outcomes(10.0, 1.0));
}
