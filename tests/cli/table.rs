//! `table`: the paper's numbers compared with ours, as files and on standard output.

use crate::support::{Place, documented};
use localshape::internals::ratio;

#[cfg(feature = "render")]
const FILES: [&str; 5] = ["table1-orientations.csv", "table1.csv", "table1.md", "table1.pdf", "table1.svg"];
#[cfg(not(feature = "render"))]
const FILES: [&str; 3] = ["table1-orientations.csv", "table1.csv", "table1.md"];

/// The rows of the first table in a Markdown text, without headings and rule. All have as many cells as the headings.
fn markdown_rows(text: &str) -> Vec<Vec<&str>> {
    let table = text.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let rows: Vec<Vec<_>> = table.map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{text}");
    rows[2..].to_vec()
}

/// One start of Table 1: a second or two.
#[test]
fn table1_is_the_same_for_any_number_of_threads_and_can_be_read() {
    let place = Place::new();
    let ran = place.run("table table1 --orientations 1 --threads 1").good();
    let silent = place.run("table table1 --orientations 1 --threads 2 -o two --quiet").good();
    assert_eq!(silent.out, "");
    assert_eq!(place.names("output/table1"), FILES);
    assert_eq!(place.names("two"), FILES);
    for file in FILES {
        let bytes = |folder: &str| std::fs::read(place.path(folder).join(file)).expect("a file");
        assert!(bytes("output/table1") == bytes("two"), "{file}");
    }

    let markdown = place.read("two/table1.md");
    assert!(
        ran.out.starts_with(&markdown)
            && ran.out.contains("In output/table1: table1.md, table1.csv, table1-orientations.csv")
    );
    let rows = markdown_rows(&markdown);
    let first: Vec<_> = rows.iter().map(|row| (row[0], row[1])).collect();
    let letters = ["A", "B", "C", "D"];
    let expected: Vec<_> = ["1e4", "1e5", "1e6"].into_iter().flat_map(|k| letters.map(|row| (k, row))).collect();
    assert_eq!(first, expected);
    assert_eq!((rows[0][4], rows[0][8], rows[3][4]), ("4.53", "30.9", "–"), "the paper's");

    let records = |file: &str| -> Vec<csv::StringRecord> {
        let text = place.read(file);
        csv::Reader::from_reader(text.as_bytes()).records().map(|row| row.expect("a whole row")).collect()
    };
    let (summary, courses) = (records("two/table1.csv"), records("two/table1-orientations.csv"));
    assert_eq!((summary.len(), courses.len()), (30, 30));
    // Mean, deviation and maximum of the one start are those of the medians.
    for (summary, course) in summary.iter().zip(&courses) {
        assert_eq!([&summary[9], &summary[12], &summary[13]], [&course[11], &course[12], &course[13]]);
        assert_eq!(&course[14], "ok");
        let (evaluations, step) = (course[10].parse::<f64>().unwrap(), course[4].parse::<f64>().unwrap());
        assert!((evaluations * step - 10.0).abs() <= step, "ten seconds");
    }
}

#[test]
fn columns_are_documented() {
    let place = Place::new();
    place.run("table table1 --orientations 1").good();
    let columns = |text: &str| text.lines().next().expect("heads").split(',').map(str::to_owned).collect::<Vec<_>>();
    for file in ["table1.csv", "table1-orientations.csv"] {
        assert_eq!(documented(file), columns(&place.read(&format!("output/table1/{file}"))), "{file}");
    }
    let protocol = ratio::Protocol { sides: vec![1], rounds: 1, turn: 1 };
    let ratios = ratio::measure(&protocol, &|_| true).expect("nobody stops it");
    assert_eq!(documented("ratio.csv"), columns(&ratios.files()[1]));
}

#[test]
fn wrong_words() {
    let place = Place::new();
    place.run("table tabel1").bad(2, &["tabel1", "'table1'", "ratio", "all"]);
    place.run("table ratios").bad(2, &["'ratio'"]);
    place.run("table table1 --orientations 0").bad(2, &["--orientations", "1..=10000"]);
    place.run("table --threads 0").bad(2, &["--threads"]);
    place.run("table --json --quiet").bad(2, &["--json", "--quiet"]);
    assert_eq!(place.names("."), [""; 0]);
}

#[test]
fn files_of_others_and_of_another_choice_are_refused_unless_told() {
    let place = Place::new();
    place.write("out/table1.csv", "mine");
    place.run("table table1 -o out").bad(2, &["out holds table1.csv", "not written by localshape", "--overwrite"]);
    // With all tables, every folder is inspected before anything is computed.
    place.write("all/ratio/ratio.md", "mine");
    place.run("table -o all").bad(2, &["ratio.md", "not written by localshape"]);
    assert_eq!(place.names("all"), ["ratio"]);

    place.run("table table1 -o out --orientations 1 --overwrite").good();
    assert_eq!(place.names("out"), FILES);
    let before = place.read("out/table1.csv");
    place.run("table table1 -o out").bad(2, &["out holds", "table1 --orientations 1`", "--overwrite"]);
    assert_eq!(place.read("out/table1.csv"), before);
    let document = place.run("table table1 -o out --orientations 1 --json").good().json();
    assert_eq!(place.read("out/table1.csv"), before);
    let table = &document["tables"][0];
    assert_eq!((table["table"].as_str(), table["folder"].as_str()), (Some("table1"), Some("out")));
    assert_eq!(table["files"].as_array().unwrap().len(), FILES.len());
    assert_eq!(table["rows"][0]["paper"]["mean"], 4.52554);
    assert!(table["rows"][0]["mean"]["median"].as_f64().unwrap() > 0.1);
}

/// Nothing is written of an interrupted measurement, and earlier files are kept.
#[cfg(unix)]
#[test]
fn interrupted() {
    use crate::interrupt::{signal, start};
    let place = Place::new();
    for (name, table) in [("INT", "table1 --orientations 10000"), ("TERM", "ratio")] {
        let folder = format!("out-{name}");
        let running = start(&place, &format!("table {table} -o {folder}"), &folder);
        std::thread::sleep(std::time::Duration::from_millis(100));
        signal(&running, &[name]);
        let ran = running.wait();
        assert_eq!(ran.status, Some(130), "{ran:?}");
        assert!(ran.out.starts_with("interrupted; "), "{ran:?}");
        assert_eq!(place.names(&folder), [""; 0]);
    }
}
