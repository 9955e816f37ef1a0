//! All forms of tables.

use super::*;

#[test]
fn all_forms_can_be_read_again() {
    let table = Table::of([[("name", "a, \"b\"".into()), ("|w|", Cell::Given(1.5)), ("none", Cell::Empty)]]);
    assert_eq!(table.csv(), "name,|w|,none\n\"a, \"\"b\"\"\",1.5,\n");
    assert_eq!(table.markdown(1), "| name | \\|w\\| | none |\n| --- | ---: | ---: |\n| a, \"b\" | 1.5 |  |");
    assert_eq!(table.json(), json!([{ "name": "a, \"b\"", "|w|": 1.5, "none": null }]));
}

#[test]
fn results_survive_reading() {
    for number in [0.1, -1.0 / 3.0, 5e-324, f64::MAX, 0.0] {
        let text = Cell::from(number).text();
        assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
    }
    assert_eq!(Cell::from(f64::NAN).text(), "nan");
}

#[test]
fn figures_have_three_digits() {
    let cases = [
        (0.0, "0"),
        (4.525_54, "4.53"),
        (30.875_97, "30.9"),
        (9.999, "10.0"),
        (0.001_234_5, "0.00123"),
        (0.000_999_9, "0.00100"),
        (4.93e-4, "4.93e-4"),
        (123_456.0, "123456"),
        (-0.02, "-0.0200"),
        (f64::INFINITY, "inf"),
    ];
    for (number, text) in cases {
        assert_eq!(figure(number), text);
    }
}
