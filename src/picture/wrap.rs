//! Breaking text into lines.

use super::text::{Fonts, Weight};
use crate::look::font::is_invisible;

/// Lines of a text that are at most `room` wide (px) at a weight and a size; longer words are cut.
pub(super) fn wrapped(fonts: &Fonts, text: &str, weight: Weight, size: f64, room: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let text: String = text.chars().filter(|&character| !is_invisible(character)).collect();
    for paragraph in text.lines() {
        let (mut line, mut wide) = (String::new(), 0.0);
        // A number is parted from its unit only where both are too wide for a line.
        let parted = |word: String| -> Vec<String> {
            if fonts.width(&word, weight, size) <= room {
                vec![word]
            } else {
                word.split(' ').map(str::to_owned).collect()
            }
        };
        for word in &words(paragraph).into_iter().flat_map(parted).collect::<Vec<_>>() {
            let space = if line.is_empty() { "" } else { " " };
            let added = fonts.width(space, weight, size) + fonts.width(word, weight, size);
            if wide + added <= room {
                line.push_str(space);
                line.push_str(word);
                wide += added;
                continue;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            for character in word.chars() {
                line.push(character);
                if fonts.width(&line, weight, size) > room && line.chars().count() > 1 {
                    line.pop();
                    lines.push(std::mem::replace(&mut line, character.to_string()));
                }
            }
            wide = fonts.width(&line, weight, size);
        }
        lines.push(line);
    }
    lines
}

/// The width of the widest word of a text (px) at a weight and a size, where a number and its unit are one.
pub(super) fn widest_word(fonts: &Fonts, text: &str, weight: Weight, size: f64) -> f64 {
    words(text).iter().map(|word| fonts.width(word, weight, size)).fold(0.0, f64::max)
}

/// The words of a paragraph; a number and a short word after it, such as a unit, are one.
fn words(paragraph: &str) -> Vec<String> {
    /// The longest units, such as `kg/m³`.
    const UNIT: usize = 5;
    let is_number = |word: &str| {
        let digits = word.trim_start_matches('−');
        digits.starts_with(|first: char| first.is_ascii_digit()) && digits.parse::<f64>().is_ok()
    };
    let is_short = |word: &str| word.trim_end_matches([',', '.', ';', ':', ')']).chars().count() <= UNIT;
    let mut words: Vec<String> = Vec::new();
    for word in paragraph.split_whitespace() {
        let number = words.last_mut().filter(|last| is_number(last) && is_short(word));
        match number {
            Some(number) => *number += &format!(" {word}"),
            None => words.push(word.to_owned()),
        }
    }
    words
}

/// As many lines as [`wrapped`], as evenly long as possible, without a last line of one short word.
pub(super) fn balanced(fonts: &Fonts, text: &str, weight: Weight, size: f64, room: f64) -> Vec<String> {
    let mut best = wrapped(fonts, text, weight, size, room);
    let (mut low, mut high) = (room / best.len().max(1) as f64, room);
    while high - low > 0.1 * size {
        let middle = low.midpoint(high);
        let lines = wrapped(fonts, text, weight, size, middle);
        // Narrower room would cut words, too.
        let is_whole = lines.join(" ") == best.join(" ");
        (low, high) = if lines.len() <= best.len() && is_whole { (low, middle) } else { (middle, high) };
        if high == middle {
            best = lines;
        }
    }
    best
}

/// As many lines as fit. If some are left out, the last one ends in an ellipsis.
pub(super) fn cut(mut lines: Vec<String>, room: usize) -> Vec<String> {
    let is_cut = lines.len() > room;
    lines.truncate(room);
    if let Some(last) = lines.last_mut().filter(|_| is_cut) {
        last.pop();
        last.push('…');
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_are_cut_between_words() {
        let fonts = Fonts::default();
        let title = "dropped from 5 m: with springs of 10 kN/m, and a density of 300 kg/m³, at −3 mm/s";
        for room in 200..400 {
            let lines = wrapped(&fonts, title, Weight::Regular, 16.0, f64::from(room));
            let ends_in_number = |line: &String| line.ends_with(|last: char| last.is_ascii_digit());
            assert!(!lines.iter().any(ends_in_number), "{lines:?}");
        }
        let text = "One two three four five.\nA new line, anunusuallylongwordthatfitsnowhere end";
        let lines = wrapped(&fonts, text, Weight::Regular, 16.0, 120.0);
        let letters = |text: &str| text.split_whitespace().collect::<String>();
        assert_eq!(letters(&lines.concat()), letters(text));
        assert!(lines.len() > 4 && lines.iter().any(|line| line.starts_with("A new")));
        let fits = |line: &String| fonts.width(line, Weight::Regular, 16.0) <= 120.0;
        assert!(lines.iter().all(fits), "{lines:?}");
        let title = "A rod presses a block: under it, springs turn elements inside out";
        let [first, even] = [wrapped, balanced].map(|wrap| wrap(&fonts, title, Weight::SemiBold, 30.0, 430.0));
        let shortest = |lines: &[String]| lines.iter().map(|line| line.chars().count()).min();
        assert!(first.len() == even.len() && first.join(" ") == even.join(" "));
        assert!(shortest(&first) == Some(10) && shortest(&even) == Some(19), "{first:?} {even:?}");
        assert!(wrapped(&fonts, "", Weight::Regular, 16.0, 120.0).is_empty());
    }
}
