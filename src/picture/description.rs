//! The second lines of panels: the descriptions of runs side by side, with as many of their parts as fit.
//!
//! Parts are left out whole: a number without its middle would be another number. What follows from other parts goes first, then what most
//! descriptions share, and last what tells runs apart. What goes from one goes from all: a part that one run lacks would look like a
//! difference.

/// The separator of the parts of a description.
const BETWEEN: &str = ", ";
/// From this number of panels on, only the first one has the parts that all share.
const MANY: usize = 4;

/// The parts of a description. A part that begins with `also` belongs to the one before it.
fn parts(description: &str) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    for part in description.split(BETWEEN).filter(|part| !part.is_empty()) {
        match parts.last_mut().filter(|_| part.starts_with("also ")) {
            Some(last) => *last = format!("{last}{BETWEEN}{part}"),
            None => parts.push(part.to_owned()),
        }
    }
    parts
}

/// What a part says: `E`, `ζ`, or how many elements there are.
fn subject(part: &str) -> &str {
    match part.split_once(" = ") {
        Some((name, _)) => name,
        None if part.starts_with(|first: char| first.is_ascii_digit()) => "",
        None => part,
    }
}

const EXACT: &str = "exact rotations";

/// Whether a part of the description of a run among all follows from its other parts, or is the usual choice and no difference.
fn follows(part: &str, own: &[String], all: &[Vec<String>]) -> bool {
    let has_modulus = || own.iter().any(|part| part.starts_with("E = "));
    let is_difference = || all.iter().any(|other| own.iter().filter(|part| *part != EXACT).eq(other.iter()));
    part.starts_with("k = ") && has_modulus() || part == EXACT && !is_difference()
}

/// The second lines of the panels of runs with descriptions.
pub(super) fn second_lines(descriptions: &[&str], fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut all: Vec<_> = descriptions.iter().map(|description| parts(description)).collect();
    let is_long = |all: &[Vec<String>], at: usize| !shown(all, at).is_empty() && !fits(&shown(all, at).join(BETWEEN));
    while let Some(at) = (0..all.len()).find(|&at| is_long(&all, at)) {
        shorten(&mut all, at);
    }
    (0..all.len()).map(|at| shown(&all, at).join(BETWEEN)).collect()
}

/// The parts in the panel of a run.
fn shown(all: &[Vec<String>], at: usize) -> Vec<&str> {
    let is_shared = |part: &String| all.iter().all(|own| own.contains(part));
    let is_shown = |part: &&String| at == 0 || all.len() < MANY || !is_shared(part);
    all[at].iter().filter(is_shown).map(String::as_str).collect()
}

/// Leaves out what matters least of a run, and the same of all others.
fn shorten(all: &mut [Vec<String>], at: usize) {
    let own = &all[at];
    // Whoever reads the first of several bodies alone would take it for all.
    let bodies = own.join(BETWEEN).matches("; ").count() + 1;
    if bodies > 1 {
        all[at] = vec![format!("{bodies} bodies")];
        return;
    }
    let rank = |part: &str| match follows(part, own, all) {
        true => 0,
        false => 1 + all.iter().filter(|other| !other.iter().any(|own| own == part)).count(),
    };
    let Some(gone) = shown(all, at).into_iter().rev().min_by_key(|part| rank(part)).map(str::to_owned) else { return };
    let (follows_here, before) = (follows(&gone, own, all), all.to_vec());
    for own in all {
        let goes = |part: &String| subject(part) == subject(&gone) && (!follows_here || follows(part, own, &before));
        *own = own.iter().filter(|part| !goes(part)).cloned().collect();
    }
}

/// Whether the second line of each run lacks more than what follows from its other parts.
pub(super) fn are_shortened(descriptions: &[&str], lines: &[String]) -> Vec<bool> {
    let [all, lines]: [Vec<_>; 2] = [
        descriptions.iter().map(|description| parts(description)).collect(),
        lines.iter().map(|line| parts(line)).collect(),
    ];
    let is_lost = |at: usize, part: &String| {
        let is_told = lines[at].contains(part) || all.len() >= MANY && lines[0].contains(part);
        !is_told && !follows(part, &all[at], &all)
    };
    (0..all.len()).map(|at| all[at].iter().any(|part| is_lost(at, part))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BRAKES: &str = "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1, also of rotation, exact rotations, k = 10 kN/m";
    const BENDS: &str = "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1 of deformation, β = 1/3, exact rotations, k = 10 kN/m";
    const BODIES: &str = "bar k = 1 kN/m, ζ = 0.1; cube k = 2 kN/m, ζ = 0.1";

    fn short(all: &[&str], most: usize) -> Vec<String> {
        second_lines(all, |text| text.chars().count() <= most)
    }

    #[test]
    fn what_tells_runs_apart_is_left_out_last() {
        let both = [BRAKES, BENDS];
        assert_eq!(short(&both, 100), both);
        let expected = [
            "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1, also of rotation",
            "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1 of deformation, β = 1/3",
        ];
        assert_eq!(short(&both, 65), expected);
        assert_eq!(are_shortened(&both, &short(&both, 65)), [false; 2], "what follows is not missed");
        assert_eq!(short(&both, 32), ["ζ = 0.1, also of rotation", "ζ = 0.1 of deformation, β = 1/3"]);
        assert_eq!(are_shortened(&both, &short(&both, 32)), [true; 2]);
        assert_eq!(short(&both, 10), ["", "β = 1/3"]);
        // Parts of one run alone go from the end.
        assert_eq!(short(&[BENDS], 50), ["27 cubes, E = 200 kPa, ν = 0"]);
        assert_eq!(short(&[BODIES, BRAKES], 45)[0], "2 bodies");
    }

    #[test]
    fn runs_side_by_side_say_the_same_things() {
        // The first has room for its `k`, and for its modulus.
        let expected = [
            "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1, also of rotation, exact rotations",
            "27 cubes, E = 200 kPa, ν = 0, ζ = 0.1 of deformation, β = 1/3, exact rotations",
        ];
        assert_eq!(short(&[BRAKES, BENDS], 88), expected);
        let expected = ["27 cubes, ζ = 0.1, also of rotation", "27 cubes, ζ = 0.1 of deformation, β = 1/3"];
        assert_eq!(short(&[BRAKES, BENDS], 50), expected);
        let springs = "54 springs, k = 10 kN/m, ζ = 0.1";
        assert_eq!(short(&[springs, BENDS], 44), ["54 springs, k = 10 kN/m", "27 cubes, E = 200 kPa, ν = 0"]);
        // The rotations are all that differs.
        let exact = "27 cubes, k = 10 kN/m, exact rotations";
        let both = [exact, "27 cubes, k = 10 kN/m"];
        assert_eq!(short(&both, 30), ["27 cubes, exact rotations", "27 cubes"]);
        assert_eq!(are_shortened(&both, &short(&both, 30)), [true, true]);
    }

    #[test]
    fn many_runs_share_a_line_and_keep_their_differences() {
        let all = [1, 2, 3, 4].map(|damping| format!("8 cubes, E = 200 kPa, ν = 0, ζ = 0.{damping}, exact rotations"));
        let all = all.each_ref().map(String::as_str);
        assert_eq!(short(&all, 60)[..2], ["8 cubes, E = 200 kPa, ν = 0, ζ = 0.1, exact rotations", "ζ = 0.2"]);
        assert_eq!(short(&all, 25), ["8 cubes, ζ = 0.1", "ζ = 0.2", "ζ = 0.3", "ζ = 0.4"]);
        assert_eq!(are_shortened(&all, &short(&all, 60)), [false; 4]);
    }
}
