//! `info`, `schema` and `completions`; and closed standard output.

use crate::cli::support::{Place, Running, run};

#[test]
fn information_works_without_any_driver() {
    let place = Place::new();
    let nowhere = place.path("nowhere.json");
    let none = |arguments: &str| {
        let mut command = place.command(arguments.split(' '));
        run(command.env("VK_DRIVER_FILES", &nowhere).env("VK_ICD_FILENAMES", &nowhere))
    };
    for ran in [place.run("info"), none("info")].map(crate::cli::support::Ran::good) {
        assert!(ran.out.starts_with(concat!("localshape ", env!("CARGO_PKG_VERSION"))), "{}", ran.out);
        assert!(ran.out.contains("adapters") && ran.out.contains("thread"), "{}", ran.out);
    }
    if cfg!(feature = "render") {
        // Bodies in the plane are drawn without one, too.
        place.write("plane.toml", include_str!("../../scenes/fig4a.toml"));
        none("render plane.toml --frames 0,90 --size 320x200 --adapter none-such").warned("the charts are left out");
        assert_eq!(place.json("output/plane/run.json")["adapter"], "none");
    }
    let document = none("info --json").json();
    assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
    if cfg!(all(feature = "render", target_os = "linux")) {
        assert!(none("info").out.contains("mesa-vulkan-drivers"), "it says what to install");
        assert_eq!(document["adapters"].as_array().unwrap().len(), 0);
    }
}

/// The width is that of the kernels, not the one for which the compiler optimised.
#[test]
fn the_vectors_are_those_of_the_kernels() {
    let expected = match () {
        #[cfg(target_arch = "x86_64")]
        () if std::is_x86_feature_detected!("avx512f") && std::is_x86_feature_detected!("fma") => ("AVX-512", 512),
        #[cfg(target_arch = "x86_64")]
        () if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") => ("AVX2", 256),
        #[cfg(target_arch = "aarch64")]
        () => ("NEON", 128),
        #[cfg(not(target_arch = "aarch64"))]
        () => return,
    };
    let place = Place::new();
    let told = place.run("info --json").good().json()["vectors"].clone();
    assert_eq!(told, serde_json::json!({ "instructions": expected.0, "bits": expected.1 }));
    let text = place.run("info").good().out;
    assert!(text.contains(&format!("  vectors     {}, {} bits\n", expected.0, expected.1)), "{text}");
    assert!(!text.contains("sse2"), "{text}");
}

#[test]
fn the_schema_is_one_document() {
    let document = Place::new().run("schema").good().json();
    assert!(document["$schema"].is_string());
    assert!(document["properties"]["body"].is_object());
    let document = Place::new().run("schema --figure").good().json();
    assert!(document["$schema"].is_string());
    assert!(document["properties"]["sheet"].is_object() && document["properties"]["body"].is_null());
    Place::new().run("schema --figures").bad(2, &["--figure"]);
}

#[test]
fn the_references_in_docs_are_current() {
    let place = Place::new();
    for (options, page) in
        [("", include_str!("../../docs/scenes.md")), (" --figure", include_str!("../../docs/figures.md"))]
    {
        let ran = place.run(&format!("schema --markdown{options}")).good();
        let name = if options.is_empty() { "scenes" } else { "figures" };
        assert!(ran.out == page, "run: localshape schema --markdown{options} > docs/{name}.md");
        for section in page.split("](#").skip(1).map(|link| link.split(')').next().unwrap()) {
            let anchor = |line: &str| line.replace(['#', ' ', '`', '[', ']', '.'], "");
            assert!(page.lines().any(|line| line.starts_with("##") && anchor(line) == section), "#{section}");
        }
    }
    let example = include_str!("../../docs/scenes.md").split("```toml").nth(1).unwrap().split("```").next().unwrap();
    place.write("example.toml", example);
    assert_eq!(place.run("check example.toml").good().err, "", "no warnings");
}

#[test]
fn completions_for_each_shell() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(place.run(&format!("completions {shell}")).good().out.contains("overwrite"), "{shell}");
    }
    place.run("completions csh").bad(2, &["csh", "bash"]);
}

/// A reader that closes the pipe early is not an error.
#[test]
fn a_closed_pipe_is_no_failure() {
    let place = Place::with_small();
    place.write("other.toml", crate::cli::support::SMALL);
    for arguments in
        ["schema", "completions bash", "info", "check small.toml", "simulate small.toml other.toml", "--help"]
    {
        let mut command = place.command(arguments.split(' '));
        // The reading end is closed before the program writes anything.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let ran = Running::start_into(&mut command, writer).wait();
        assert_eq!((ran.status, ran.err.as_str()), (Some(0), ""), "{arguments}");
    }
    // The work is done nevertheless.
    assert_eq!(place.names("output/other"), ["diagnostics.csv", "run.json"]);
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_cannot_be_written() {
    let place = Place::with_small();
    for arguments in ["schema", "check small.toml", "simulate small.toml --json"] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = place.command(arguments.split(' '));
        Running::start_into(&mut command, full).wait().bad(4, &["standard output"]);
    }
}

/// Programs may be started without standard output and error.
#[cfg(unix)]
#[test]
fn closed_outputs() {
    let place = Place::with_small();
    let program = env!("CARGO_BIN_EXE_localshape");
    for (arguments, status) in [("simulate small.toml -o out", 0), ("check absent.toml", 2), ("nonsense", 2)] {
        let line = format!("'{program}' {arguments} >&- 2>&-");
        let mut shell = std::process::Command::new("sh");
        let ran = run(shell.args(["-c", &line]).current_dir(place.path(".")));
        assert_eq!(ran.status, Some(status), "{arguments}");
    }
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json"]);
}
