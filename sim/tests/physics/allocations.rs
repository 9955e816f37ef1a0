//! Steps in which surfaces touch allocate nothing, once their lists have grown.

use super::surfaces::{Placed, SIDE, block, by, still};
use glam::DVec3;
use localshape_sim::{Contacts, Crew, Integrator, Kernel, Motion, Obstacle, Shape, Surroundings, World};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// Counts what each thread allocates.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[expect(unsafe_code, reason = "allocations cannot be counted otherwise")]
// SAFETY: all is left to the allocator of the system.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Four blocks in a wall on a box.
fn wall() -> World {
    const GAP: f64 = 0.0025;
    let body = block([3, 2, 3]);
    let placed: Vec<_> = (0..4)
        .map(|at| {
            let place = DVec3::new(0.31 * f64::from(at % 2), (2.0 * SIDE + GAP) * f64::from(at / 2), 0.0);
            let speed = DVec3::new(0.0, if at < 2 { 0.0 } else { -1e-3 }, 1e-4 * f64::from(at));
            (Arc::clone(&body), Placed { speed, ..still(place) })
        })
        .collect();
    let shape = Shape::Box {
        centre: DVec3::Y * (-SIDE - 0.5 * GAP - 0.1),
        half: DVec3::new(1.0, 0.1, 1.0),
        rotation: Default::default(),
    };
    let obstacle = Obstacle {
        shape,
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.5,
        friction_of: Default::default(),
    };
    let around = Surroundings {
        gravity: DVec3::Y * -9.8,
        obstacles: vec![obstacle],
        contacts: Some(Contacts { friction: 0.5, ..Contacts::default() }),
        ..Surroundings::default()
    };
    let mut world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &placed, 1e5, 0.02, around);
    world.set_crew(Crew::new(1));
    world
}

#[test]
fn steps_with_contact_allocate_nothing() {
    let mut world = wall();
    world.advance(400);
    let mut count = |steps: u64| {
        let before = COUNT.get();
        world.advance(steps);
        COUNT.get() - before
    };
    // Lists are made anew now and then.
    let [few, many] = [2, 22].map(|steps| (0..20).map(|_| count(steps)).min());
    assert_eq!([few, many], [Some(0); 2]);
    assert!(world.contact_points().len() > 50, "they touch");
}
