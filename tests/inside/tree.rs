//! Boxes of a page, and those that are left out.

use super::*;

/// A page of a size in words: each box with its left, top, width and height, then those without room.
fn said(size: [f64; 2]) -> String {
    let panel = || {
        Node::new("panel", 0.0).stretched().with(vec![
            Node::new("name", 20.0).rank(1),
            Node::new("events", 20.0).rank(0),
            Node::new("body", 60.0).stretched(),
        ])
    };
    let page = [
        Node::new("title", 30.0).rank(2),
        Node::new("panels", 100.0).stretched().with(vec![panel(), panel()]),
        Node::new("chart", 80.0).least(40.0).share(0.25).rank(1),
        Node::new("caption", 20.0).rank(0),
        Node::new("caption", 20.0).rank(0),
    ];
    let Solved { places, left_out } = column(&page, [0.0, 0.0, size[0], size[1]]);
    let places = places.iter().map(|(key, [left, top, width, height])| format!("{key} {left} {top} {width} {height}"));
    places.chain([format!("left out: {}", left_out.join(", "))]).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_page_has_fewer_boxes_the_smaller_it_is() {
    let large = "title 0 0 400 30\npanels 0 30 400 310\n\
                 panel 0 30 200 310\nname 0 30 200 20\nevents 0 50 200 20\nbody 0 70 200 270\n\
                 panel 200 30 200 310\nname 200 30 200 20\nevents 200 50 200 20\nbody 200 70 200 270\n\
                 chart 0 340 400 80\ncaption 0 420 400 20\ncaption 0 440 400 20\nleft out: ";
    assert_eq!(said([400.0, 460.0]), large);
    let small = "title 0 0 90 30\npanels 0 30 90 100\n\
                 panel 0 30 45 100\nname 0 30 45 20\nevents 0 50 45 20\nbody 0 70 45 60\n\
                 panel 45 30 45 100\nname 45 30 45 20\nevents 45 50 45 20\nbody 45 70 45 60\n\
                 chart 0 130 90 40\nleft out: caption, caption";
    assert_eq!(said([90.0, 170.0]), small);
    let least = "panels 0 0 90 70\n\
                 panel 0 0 45 70\nbody 0 0 45 70\npanel 45 0 45 70\nbody 45 0 45 70\n\
                 left out: title, name, events, name, events, chart, caption, caption";
    assert_eq!(said([90.0, 70.0]), least);
}

#[test]
fn a_smaller_box_has_room_where_a_more_important_one_has_none() {
    let caption = |gap| Node::new("caption", 20.0).after(gap).rank(1);
    let nodes = [
        Node::new("panels", 100.0),
        Node::new("chart", 60.0).rank(2),
        Node::new("chart", 20.0).rank(0),
        caption(10.0),
        caption(0.0),
    ];
    let left_out = |height| column(&nodes, [0.0, 0.0, 10.0, height]).left_out;
    assert_eq!(left_out(230.0), [""; 0]);
    assert_eq!(left_out(210.0), ["chart"]);
    assert_eq!(left_out(190.0), ["chart", "caption"]);
    // No chart without the chart before it, and no line of the caption without the line before it.
    assert_eq!(left_out(150.0), ["chart", "chart"]);
    assert_eq!(left_out(125.0), ["chart", "chart", "caption", "caption"]);
}

#[test]
fn a_box_longer_than_its_share_is_left_out() {
    let nodes = [Node::new("panels", 20.0), Node::new("chart", 40.0).share(0.25).rank(1)];
    let left_out = |height| column(&nodes, [0.0, 0.0, 10.0, height]).left_out;
    assert_eq!(left_out(160.0), [""; 0]);
    assert_eq!(left_out(159.0), ["chart"], "though there is room for it");
}

#[test]
fn spare_room_is_shared_up_to_the_largest_lengths() {
    let nodes = [Node::new(0, 10.0).most(25.0), Node::new(1, 10.0), Node::new(2, 40.0).least(20.0).most(60.0)];
    let of = |length: f64| lengths(&nodes, length).into_iter().map(Option::unwrap).collect::<Vec<_>>();
    assert_eq!(of(20.0), [5.0, 5.0, 10.0]);
    assert_eq!(of(50.0), [10.0, 10.0, 30.0]);
    assert_eq!(of(80.0), [20.0, 10.0, 50.0]);
    assert_eq!(of(200.0), [25.0, 10.0, 60.0]);
}
