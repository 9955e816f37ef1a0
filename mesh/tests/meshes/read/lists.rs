//! VTK's lists of files.

use localshape_mesh::{Listed, read_list};

fn list(sets: &str) -> Result<Vec<Listed>, String> {
    let text =
        format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"><Collection>{sets}</Collection></VTKFile>");
    read_list(text.as_bytes()).map_err(|error| error.message)
}

#[test]
fn files_are_listed_with_their_times() {
    let found = list(
        "<DataSet timestep='0' part='0' file='a &lt;b&gt;/c_0.vtu'/><DataSet timestep='0.5' file='d.vtu'></DataSet>",
    );
    let expected = [(0.0, "a <b>/c_0.vtu", Some("0")), (0.5, "d.vtu", None)].map(|(time, file, part)| Listed {
        time,
        file: file.to_owned(),
        part: part.map(str::to_owned),
    });
    assert_eq!(found.unwrap(), expected);
}

#[test]
fn mistakes_are_told_with_their_places() {
    for (sets, message) in [
        ("", "lists no file"),
        ("<DataSet file='a.vtu'/>", "without `timestep`"),
        ("<DataSet timestep='0'/>", "without `file`"),
        ("<DataSet timestep='soon' file='a.vtu'/>", "has the time `soon`"),
        ("<DataSet timestep='0' file='a'", "is no sound XML"),
    ] {
        let error = list(sets).unwrap_err();
        assert!(error.contains(message), "{sets}: {error}");
    }
    let of_commas =
        r#"<VTKFile type="Collection"><Collection><DataSet timestep="0,5" file="a.vtu"/></Collection></VTKFile>"#;
    let help = read_list(of_commas.as_bytes()).unwrap_err().help;
    assert_eq!(help.as_deref(), Some("write a decimal point, not a comma: 0.5"));
    assert!(read_list(b"").unwrap_err().message.contains("no `<VTKFile>`"));
    assert!(read_list(b"<VTKFile type='UnstructuredGrid'/>").unwrap_err().message.contains("expected `Collection`"));
}
