//! Scenes made in code, as in another crate.

use localshape::glam::DVec3;
use localshape::look::Theme;
use localshape::scene::{
    BodyBuilder, Cells, ContactBuilder, Lattice, Limits, MotionPath, NodeSet, ObstacleBuilder, PairBuilder, Rotation,
    RunBuilder, Scene, SceneBuilder, Side, Start, StartShape, Swing,
};
use localshape::sim::model::{ElasticModel, ForceModel, Properties, Report, Scratch, Share, mass_spring, shape_based};
use localshape::sim::{Body, Diagnostic, Ease, Field, Integrator, Kernel, Nodes, Springs};
use std::sync::Arc;

fn springs(stiffness: f64) -> mass_spring::Parameters {
    mass_spring::Parameters::new(stiffness)
}

fn shape(stiffness: f64) -> shape_based::Parameters {
    shape_based::Parameters::new(stiffness)
}

/// A scene made in code and the same one from a file are equal in everything, including the digest.
fn assert_same(made: SceneBuilder, file: &str) {
    let parsed = Scene::parse(file, "scene.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}\n{file}"));
    let made = made.build(&Limits::default()).unwrap_or_else(|error| panic!("{error}\n{file}"));
    assert!(!made.digest.is_empty());
    // Digests cover titles. Names are not compared, as files have their own, nor warnings, whose places are of their own.
    let plain = |scene| format!("{:#?}", Scene { name: String::new(), warnings: Vec::new(), ..scene });
    let [made, parsed] = [made, parsed].map(plain);
    assert_eq!(made, parsed, "{file}");
}

#[test]
fn code_and_files_make_the_same_scenes() {
    let run = "[[run]]\nname = 'One'\nmodel = { kind = 'shape-based', stiffness = 1.0 }\n";
    let head = |body: &str| format!("title = 'scene'\ntime.duration = 1\n[body]\n{body}\n{run}");
    let one = |body: BodyBuilder| Scene::builder("scene", body).run("One", shape(1.0));

    let rest = [[0.0, 0.0, 0.0], [1e3, 0.0, 0.0], [0.0, 1e3, 0.0], [0.0, 0.0, 1e3]];
    let body = || BodyBuilder::arrays(rest, [[0, 1, 2, 3]]);
    let space = "nodes = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]\nelements = [[0, 1, 2, 3]]";
    assert_same(one(body()), &head(space));
    let ball = "[[obstacle]]\nkind = 'sphere'\ncentre = [1.5e3, 0, 0]\nradius = 300.0\n";
    assert_same(one(body()).obstacle(ObstacleBuilder::sphere([1.5e3, 0.0, 0.0], 300.0)), &(head(space) + ball));

    let pair = PairBuilder::of("body", "ball").restitution(0.5).friction(0.1).thickness(2.0);
    let contact = ContactBuilder::surfaces().restitution(0.2).friction(0.3).pair(pair);
    let named = ObstacleBuilder::sphere([1.5e3, 0.0, 0.0], 300.0).name("ball");
    let file = head(&format!("{space}\nname = 'body'\nself_contact = true\nthickness = 5.0"))
        + "[[obstacle]]\nkind = 'sphere'\nname = 'ball'\ncentre = [1.5e3, 0, 0]\nradius = 300.0
        [contact]\nrule = 'surfaces'\nrestitution = 0.2\nfriction = 0.3
        pair = [{ of = ['body', 'ball'], restitution = 0.5, friction = 0.1, thickness = 2 }]";
    let folded = BodyBuilder::arrays(rest, [[0, 1, 2, 3]]).name("body").self_contact().thickness(5.0);
    assert_same(one(folded).obstacle(named).contact(contact), &file);
    assert_same(
        one(BodyBuilder::arrays(rest, [[0, 1, 2, 3]])).contact(ContactBuilder::nodes()),
        &(head(space) + "[contact]\nrule = 'nodes'"),
    );

    let vectors = rest.map(DVec3::from_array);
    let body = BodyBuilder::arrays(vectors, vec![vec![3, 2, 1, 0]]).convex().springs([[0, 1], [1, 2]]);
    let body = body.faces([[0, 1, 2]]).masses([1.0, 2.0, 3.0, 4.0]).positions(vectors).velocities([DVec3::X; 4]);
    let lists = "nodes = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]\nelements = [[3, 2, 1, 0]]\nconvex = true
        springs = [[0, 1], [1, 2]]\nfaces = [[0, 1, 2]]\nmasses = [1, 2, 3, 4]
        positions = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]
        velocities = [[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0]]";
    assert_same(one(body), &head(lists));

    let cloud = Start::new(StartShape::Cloud).seed(3);
    let lattice = |cells: &[u32]| Lattice::new(cells, 0.1);
    for (body, typed) in [
        (BodyBuilder::lattice(lattice(&[3, 2])), "lattice = { cells = [3, 2], side = 0.1 }"),
        (
            BodyBuilder::lattice(lattice(&[3, 2, 1]).elements(Cells::Mixed).irregular(0.2).seed(7)),
            "lattice = { cells = [3, 2, 1], side = 0.1, elements = 'mixed', irregular = 0.2, seed = 7 }",
        ),
        (BodyBuilder::lattice(lattice(&[2, 2]).sides([0.1, 0.3])), "lattice = { cells = [2, 2], side = [0.1, 0.3] }"),
        (BodyBuilder::polygon(6, 0.5), "polygon = { sides = 6, radius = 0.5 }"),
        (BodyBuilder::fan(6, 0.5).mass(0.1), "fan = { sides = 6, radius = 0.5 }\nmass = 0.1"),
        (BodyBuilder::disc(1.0, 3, 12).density(2.0), "disc = { radius = 1, rings = 3, sectors = 12 }\ndensity = 2"),
        (
            BodyBuilder::bars(4, 0.5, [1.0, 1.0, 0.0]).mass_total(2.0),
            "bars = { count = 4, length = 0.5, direction = [1, 1, 0] }\nmass_total = 2",
        ),
        (
            BodyBuilder::polygon(4, 0.5)
                .rotation(Rotation::in_plane(0.3))
                .offset([1.0, 2.0])
                .lowest(0.25)
                .velocity([0.5, 0.0])
                .spin(Rotation::in_plane(2.0)),
            "polygon = { sides = 4, radius = 0.5 }\nrotation.angle = 0.3\noffset = [1, 2]\nlowest = 0.25
             velocity = [0.5, 0]\nspin.rate = 2",
        ),
        (
            BodyBuilder::fan(6, 0.5).start(Start::new(StartShape::Line).direction([0.0, 1.0])),
            "fan = { sides = 6, radius = 0.5 }\nstart = { shape = 'line', direction = [0, 1] }",
        ),
        (
            BodyBuilder::fan(6, 0.5).start(cloud),
            "fan = { sides = 6, radius = 0.5 }\nstart = { shape = 'cloud', seed = 3 }",
        ),
    ] {
        assert_same(one(body), &head(typed));
    }
}

#[test]
fn a_builder_says_all_that_a_file_can_say_of_physics() {
    let path = |to: f64| MotionPath::new().key(0.5, [0.0, 0.0, 0.0]).key(1.0, [0.0, to, 0.0]);
    let turned = Rotation::about([0.0, 1.0, 0.0], 1.5);
    let made = Scene::builder("scene", BodyBuilder::lattice(Lattice::new([2, 2, 2], 0.1)).lowest(1.0))
        .gravity([0.0, -9.8, 0.0])
        .duration(2.0)
        .steps_per_cycle(80.0)
        .integrator(Integrator::VelocityVerlet)
        .frames_per_second(30.0)
        .run("One", shape_based::Parameters { damping_ratio: Some(0.1), ..shape(1e4) })
        .run("Two", mass_spring::Parameters { springs: Some(Springs::All), ..springs(1e3) })
        .run("Three", RunBuilder::new(shape(1e4)).step(1e-3).kernel(Kernel::Reference).colour([0, 114, 178]))
        .run("Four", RunBuilder::new(springs(1e3)).steps_per_cycle(200.0).integrator(Integrator::Pefrl))
        .obstacle(ObstacleBuilder::floor(-1.0).restitution(0.5).friction(0.3))
        .obstacle(ObstacleBuilder::wall([-1.0, 0.0, 0.0], -3.0))
        .obstacle(ObstacleBuilder::plate([0.0, 3.0, 0.0], [0.0, -1.0, 0.0]).path(path(-0.5).ease(Ease::Linear)))
        .obstacle(
            ObstacleBuilder::capsule([2.0, 0.0, 0.0], [2.0, 1.0, 0.0], 0.1)
                .about([2.0, 2.0, 0.0])
                .swing(Swing::new(1.5).phase(0.5).shift([0.1, 0.0, 0.0]).rotation(turned.clone())),
        )
        .obstacle(ObstacleBuilder::cuboid([0.0, 0.0, 2.0], [0.1, 0.2, 0.3]))
        .obstacle(
            ObstacleBuilder::turned_cuboid([0.0, 0.0, -2.0], [0.1, 0.2, 0.3], turned.clone())
                .path(path(0.0).turned_key(1.5, [0.0, 0.0, 0.0], Rotation::about([0.0, 1.0, 0.0], 0.0)).repeating()),
        )
        .hold(NodeSet::list([0, 1]), ..)
        .hold(NodeSet::side(Side::Top), 0.0..0.25)
        .hold(NodeSet::ball([0.1, 1.2, 0.1], 0.01), 0.25..0.5)
        .grab(NodeSet::cuboid([-0.1, 1.15, -0.1], [0.0, 1.3, -0.05]), path(0.5))
        .size([640, 360])
        .theme(Theme::Dark)
        .colour_by(Field::Strain)
        .charts([Diagnostic::Energy])
        .camera(0.2, 0.3);
    let text = "
        title = 'scene'
        gravity = [0, -9.8, 0]
        time = { duration = 2, step = 'T/80', integrator = 'velocity-verlet', frames_per_second = 30 }
        body = { lattice = { cells = [2, 2, 2], side = 0.1 }, lowest = 1 }
        run = [
            { name = 'One', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 } },
            { name = 'Two', model = { kind = 'mass-spring', stiffness = 1e3, springs = 'all' } },
            { name = 'Three', model = { kind = 'shape-based', stiffness = 1e4 }, step = 1e-3, kernel = 'reference',
                colour = '#0072b2' },
            { name = 'Four', model = { kind = 'mass-spring', stiffness = 1e3 }, step = 'T/200',
                integrator = 'pefrl' },
        ]
        hold = [{ nodes = [0, 1] }, { nodes = 'top', until = 0.25 },
            { nodes = { of = [0.1, 1.2, 0.1], within = 0.01 }, from = 0.25, until = 0.5 }]
        view = { size = [640, 360], theme = 'dark', colour.by = 'strain', charts = ['energy'],
            camera = { azimuth = 0.2, elevation = 0.3 } }
        [[obstacle]]
        kind = 'floor'
        height = -1
        restitution = 0.5
        friction = 0.3
        [[obstacle]]
        kind = 'floor'
        normal = [-1, 0, 0]
        height = -3
        [[obstacle]]
        kind = 'plate'
        point = [0, 3, 0]
        normal = [0, -1, 0]
        path = { keys = [{ time = 0.5, shift = [0, 0, 0] }, { time = 1, shift = [0, -0.5, 0] }], ease = 'linear' }
        [[obstacle]]
        kind = 'capsule'
        from = [2, 0, 0]
        to = [2, 1, 0]
        radius = 0.1
        about = [2, 2, 0]
        swing = { period = 1.5, phase = 0.5, shift = [0.1, 0, 0], rotation = { axis = [0, 1, 0], angle = 1.5 } }
        [[obstacle]]
        kind = 'box'
        centre = [0, 0, 2]
        size = [0.1, 0.2, 0.3]
        [[obstacle]]
        kind = 'box'
        centre = [0, 0, -2]
        size = [0.1, 0.2, 0.3]
        rotation = { axis = [0, 1, 0], angle = 1.5 }
        path.repeat = true
        path.keys = [
            { time = 0.5, shift = [0, 0, 0] },
            { time = 1, shift = [0, 0, 0] },
            { time = 1.5, shift = [0, 0, 0], rotation = { axis = [0, 1, 0], angle = 0 } },
        ]
        [[grab]]
        nodes = { low = [-0.1, 1.15, -0.1], high = [0, 1.3, -0.05] }
        path.keys = [{ time = 0.5, shift = [0, 0, 0] }, { time = 1, shift = [0, 0.5, 0] }]
    ";
    assert_same(made, text);
    let made = Scene::builder("scene", BodyBuilder::polygon(3, 1.0)).step(1e-3).run("One", shape(1.0));
    let text = "title = 'scene'\ntime = { duration = 1, step = 1e-3 }\nbody.polygon = { sides = 3, radius = 1 }
        run = [{ name = 'One', model = { kind = 'shape-based', stiffness = 1 } }]";
    assert_same(made, text);
}

#[test]
fn code_and_files_make_the_same_scenes_of_several_bodies() {
    let cube = BodyBuilder::lattice(Lattice::new([2, 2, 2], 0.1)).name("cube").lowest(0.5);
    let nodes = [[0.0, 0.0, 0.0], [1e3, 0.0, 0.0], [0.0, 1e3, 0.0], [0.0, 0.0, 1e3]];
    let solid = BodyBuilder::arrays(nodes, [[0, 1, 2, 3]]).name("solid").offset([90.0, 0.0, 0.0]);
    let models = [("cube", shape(1.0).into()), ("solid", springs(2.0).into())];
    let made = Scene::builder("scene", cube)
        .body(solid)
        .run("Both", RunBuilder::by_body(models))
        .run("Solid", RunBuilder::new(shape(3.0)).bodies(["solid"]));
    let text = "title = 'scene'
        time.duration = 1
        [[body]]
        name = 'cube'
        lattice = { cells = [2, 2, 2], side = 0.1 }
        lowest = 0.5
        [[body]]
        name = 'solid'
        nodes = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]
        elements = [[0, 1, 2, 3]]
        offset = [90, 0, 0]
        [[run]]
        name = 'Both'
        models.cube = { kind = 'shape-based', stiffness = 1 }
        models.solid = { kind = 'mass-spring', stiffness = 2 }
        [[run]]
        name = 'Solid'
        model = { kind = 'shape-based', stiffness = 3 }
        bodies = ['solid']";
    assert_same(made.clone(), text);
    let wrong = made.body(BodyBuilder::arrays([[0.0, 0.0, f64::NAN]], [[0, 1]]).name("bar")).build(&Limits::default());
    let error = wrong.expect_err("a wrong number").to_string();
    assert!(error.contains("`body[2].nodes[0][2]` is NaN; expected a finite number"), "{error}");
}

/// Messages have position, finding, expectation and remedy like those about a file, but no lines of its text.
#[test]
fn mistakes_in_code_are_told_as_those_in_files() {
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let arrays = || BodyBuilder::arrays(triangle, [[0, 1, 2]]);
    let scene = |body| Scene::builder("drop", body);
    let with = |body| scene(body).run("One", shape(1e4));
    let tetrahedron = || BodyBuilder::arrays([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], [[0, 1, 2, 3]]);
    let none: [[f64; 2]; 0] = [];
    let mut differences: Vec<String> = Vec::new();
    for (wrong, expected) in [
        (scene(arrays()), "`run` is empty; expected 1 to 256"),
        (with(BodyBuilder::arrays(none, [[0, 1, 2]])), "`body.nodes` is empty; expected at least 1"),
        (with(BodyBuilder::arrays(triangle, [[0; 0]; 0])), "`body.elements` is empty; expected at least 1"),
        (
            with(BodyBuilder::arrays(triangle, [[0, 1, 3]])),
            "`body.elements[0][2]`: there is no node 3; the body has nodes 0 to 2; nodes are counted from 0",
        ),
        (
            with(BodyBuilder::arrays(triangle, [vec![0, 1, 2], vec![2]])),
            "`body.elements[1]` has 1 node; expected at least 2",
        ),
        (
            with(BodyBuilder::arrays(triangle, [[0, 2, 1]])),
            "`body.elements[0]` is clockwise; expected counter-clockwise; write [1, 2, 0]",
        ),
        (
            with(BodyBuilder::arrays([[0.0, f64::NAN], [1.0, 0.0], [0.0, 1.0]], [[0, 1, 2]])),
            "`body.nodes[0][1]` is NaN; expected a finite number",
        ),
        (
            with(BodyBuilder::arrays([[0.0, 1e31], [1.0, 0.0], [0.0, 1.0]], [[0, 1, 2]])),
            "`body.nodes[0][1]` is 10000000000000000000000000000000; expected a magnitude up to 1e30",
        ),
        (
            with(BodyBuilder::arrays([[0.0; 4], [1.0; 4]], [[0, 1]])),
            "`body.nodes[0]` has 4 coordinates; expected 3, because the body is in space",
        ),
        (with(arrays().masses([1.0, 0.0, 1.0])), "`body.masses[1]` is 0; expected a number greater than 0"),
        (with(arrays().masses([1.0])), "`body.masses` has 1 entry, and the body has 3 nodes; expected one for each"),
        (
            with(arrays().mass(1.0).masses([1.0; 3])),
            "`body` has both `mass` and `masses`, which exclude each other; keep one",
        ),
        (
            with(arrays().velocities([DVec3::X; 3])),
            "`body.velocities[0]` has 3 coordinates; expected 2, because the body is in the plane",
        ),
        (with(BodyBuilder::polygon(3, 1.0).masses([1.0; 3])), "`body.masses` needs `nodes`"),
        (with(BodyBuilder::polygon(2, 1.0)), "`body.polygon.sides` is 2; expected a whole number from 3 to 4000000000"),
        (
            with(BodyBuilder::lattice(Lattice::new([3, 0, 3], 0.1))),
            "`body.lattice.cells[1]` is 0; expected a whole number from 1 to 4000000000",
        ),
        (
            with(BodyBuilder::lattice(Lattice::new([3, 3, 3], -0.1))),
            "`body.lattice.side` is -0.1; expected a number greater than 0",
        ),
        (with(BodyBuilder::lattice(Lattice::new([1000; 3], 0.1))), "this makes 1 003 003 001 nodes"),
        (
            with(tetrahedron().rotation(Rotation::in_plane(1.0))),
            "`body.rotation.axis`: `body.rotation` has no `axis`, which a rotation in space needs; such as axis = [0, 0, 1]",
        ),
        (with(arrays()).duration(f64::INFINITY), "`time.duration` is inf; expected a finite number"),
        (with(arrays()).step(0.0), "`time.step` is 0.0; expected a number greater than 0"),
        (
            with(arrays()).run("One", shape(1.0)),
            "`run[1].name`: two runs are called \"One\": `run[0]` and `run[1]`; give each run a unique name",
        ),
        (scene(arrays()).run("", shape(1.0)), "`run[0].name` is empty; expected 1 to 80"),
        (
            with(arrays()).run("Two", shape_based::Parameters { passes: Some(3), ..shape(1.0) }),
            "`run[1].model.passes`: `passes` is about Eq. (15), but the body is in the plane, where Eq. (9) is exact; take it out",
        ),
        (
            with(arrays()).run("Two", RunBuilder::new(shape(1.0)).step(-1.0)),
            "`run[1].step` is -1.0; expected a number greater than 0",
        ),
        (
            with(arrays()).obstacle(ObstacleBuilder::floor(0.5)),
            "`obstacle[0]`: the body starts inside this floor: node 0 lies 500 mm below its surface",
        ),
        (
            with(arrays()).obstacle(ObstacleBuilder::floor(0.0).restitution(2.0)),
            "`obstacle[0].restitution` is 2.0; expected a number from 0 to 1",
        ),
        (
            with(arrays()).obstacle(ObstacleBuilder::floor(-1.0).path(MotionPath::new())),
            "`obstacle[0].path.keys` is empty; expected at least 1",
        ),
        (with(arrays()).hold(NodeSet::ball([5.0, 5.0], 0.1), ..), "`hold[0].nodes`"),
        (with(arrays()).size([0, 5]), "`view.size[0]` is 0; expected a whole number from 16 to 16384"),
    ] {
        let error = wrong.build(&Limits::default()).expect_err(expected);
        let (message, first) = (error.to_string(), &error.mistakes()[0]);
        if !(message.starts_with("drop: ") && message.contains(expected)) {
            differences.push(format!("{message}\n  expected: {expected}"));
        }
        assert_eq!((first.line, first.column, first.excerpt.as_str()), (0, 0, ""), "{message}");
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    // The documentation of a key is not repeated.
    let error = with(arrays()).run("Two", shape(-1.0)).build(&Limits::default()).expect_err("a wrong number");
    assert_eq!(error.to_string(), "drop: `run[1].model.stiffness` is -1.0; expected a number greater than 0");
}

/// Warnings about allowed but probably unintended values.
#[test]
fn warnings_name_the_setting() {
    let scene = Scene::builder("drop", BodyBuilder::polygon(3, 1.0)).run("One", shape(1.0)).frames_per_second(0.1);
    let warnings = scene.build(&Limits::default()).unwrap().warnings;
    assert_eq!(warnings.len(), 1);
    assert_eq!((warnings[0].line, warnings[0].place.as_str()), (0, "time.frames_per_second"));
}

/// A model without forces, with the properties that a test needs.
#[derive(Clone, Debug)]
struct Idle {
    stiffness: f64,
    springs: Vec<[u32; 2]>,
    /// Whether it reports a residual of rotations.
    turns: bool,
}

impl ElasticModel for Idle {
    fn properties(&self, _: &Body) -> Properties {
        Properties::new("idle", self.stiffness)
    }

    fn springs(&self) -> &[[u32; 2]] {
        &self.springs
    }

    fn prepare(&self, _: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(self.clone())
    }
}

impl ForceModel for Idle {
    fn add_forces(&self, _: Nodes<'_>, _: &[f64], _: &mut [f64], _: &mut Scratch, _: &mut [DVec3]) {}

    fn is_damped(&self) -> bool {
        false
    }

    fn report(&self, _: Nodes<'_>, _: &[f64], _: &mut Share<'_>) -> Report {
        Report { energy: None, residual: self.turns.then_some(0.0) }
    }
}

/// A model is checked by the properties that it reports, and not as if it belonged to this crate.
#[test]
fn models_of_the_caller_are_checked_by_their_own_words() {
    let idle = |stiffness| Idle { stiffness, springs: Vec::new(), turns: false };
    let scene =
        |model: Idle| Scene::builder("own", BodyBuilder::polygon(3, 1.0)).run("One", RunBuilder::own(Arc::new(model)));
    let built = scene(idle(100.0)).build(&Limits::default()).unwrap();
    assert_eq!(
        (built.digest.as_str(), built.runs[0].models[0].properties(built.runs[0].body()).stiffness),
        ("", 100.0)
    );
    let refused = |scene: SceneBuilder, limits: &Limits, expected: &str| {
        let message = scene.build(limits).unwrap_err().to_string();
        assert!(message.starts_with("own: ") && message.contains(expected), "{message}");
    };
    let limits = Limits::default();
    for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let expected = format!(
            "`run[0].model.stiffness`: the stiffness of the model is {stiffness}; expected a number greater than 0"
        );
        refused(scene(idle(stiffness)), &limits, &expected);
    }
    let springs = |springs: &[[u32; 2]]| Idle { springs: springs.to_vec(), ..idle(1.0) };
    let expected = "`run[0].model.springs`: spring 1 of the model joins the nodes 2 and 3; the body has nodes 0 to 2";
    refused(scene(springs(&[[0, 1], [2, 3]])), &limits, expected);
    let few = Limits { springs: 1, ..limits };
    scene(springs(&[[0, 1]])).build(&few).unwrap();
    refused(scene(springs(&[[0, 1], [1, 2]])), &few, "3 nodes, 1 element and up to 2 springs");
    // With springs and rotations, or with neither.
    let strip = |model: Idle| scene(model).charts([Diagnostic::Residual]);
    strip(Idle { turns: true, ..springs(&[[0, 1]]) }).build(&limits).unwrap();
    refused(strip(idle(1.0)), &limits, "`view.charts[0]` is \"residual\", which no run has; models without rotations");
}
