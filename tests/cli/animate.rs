//! `animate`: the files as read by other decoders, and messages about frames that do not fit.

use crate::cli::support::{Place, Ran, SMALL, SMALL_FRAMES, frame_file, frame_tags, has_ffmpeg, lasting, python, run};
use localshape::animation::{Animation, Format, Image, Timeline};
use localshape::internals::{Shown, Tags};
use std::path::Path;
use std::process::Command;

const SIZE: [u32; 2] = [64, 48];
/// Frames of a folder.
const COUNT: u64 = 12;

/// A frame of a bright square on a colour gradient, further to the right in each frame.
fn pixels(number: u64, [width, height]: [u32; 2]) -> Vec<u8> {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let moving = |x: u32, y: u32| (10..20).contains(&y) && (x as u64).wrapping_sub(3 * number) < 8;
    let pixel = |(x, y): (u32, u32)| if moving(x, y) { [230, 90, 20] } else { [250 - y as u8, 250 - y as u8 / 2, 240] };
    places.flat_map(pixel).collect()
}

fn tags(number: u64) -> Tags {
    // The times are ends of steps, like those of scenes.
    frame_tags(number, number as f64 / 30.0 + if number % 2 == 1 { 1e-3 } else { 0.0 })
}

fn put(place: &Place, folder: &str, number: u64, bytes: &[u8]) {
    place.write(&format!("{folder}/frame_{number:05}.png"), bytes);
}

/// A place with a folder of frames at 30 per second.
fn with_frames() -> Place {
    let place = Place::new();
    (0..COUNT).for_each(|number| put(&place, "in", number, &frame_file(SIZE, &pixels(number, SIZE), &tags(number))));
    place
}

/// The frames of an APNG as displayed, each with its delay (s), and the number of plays.
pub(crate) fn decode_apng(path: &Path) -> (Vec<(Vec<u8>, f64)>, u32) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let control = *reader.info().animation_control().expect("an animation");
    let [width, height] = [reader.info().width as usize, reader.info().height as usize];
    let mut shown = vec![0; 3 * width * height];
    let mut frames = Vec::new();
    for _ in 0..control.num_frames {
        let mut buffer = vec![0; 4 * width * height];
        reader.next_frame(&mut buffer).expect("a frame");
        let frame = *reader.info().frame_control().expect("a control");
        assert_eq!((frame.dispose_op, frame.blend_op), (png::DisposeOp::None, png::BlendOp::Over));
        for (at, pixel) in buffer.chunks_exact(4).take(frame.width as usize * frame.height as usize).enumerate() {
            let [x, y] = [at % frame.width as usize, at / frame.width as usize];
            let to = 3 * ((y + frame.y_offset as usize) * width + x + frame.x_offset as usize);
            match pixel[3] {
                255 => shown[to..to + 3].copy_from_slice(&pixel[..3]),
                opacity => assert_eq!(opacity, 0),
            }
        }
        frames.push((shown.clone(), f64::from(frame.delay_num) / f64::from(frame.delay_den)));
    }
    (frames, control.num_plays)
}

/// The frames of a GIF as displayed, each with its delay (hundredths of a second), and the number of repetitions.
fn decode_gif(path: &Path) -> (Vec<(Vec<u8>, u16)>, gif::Repeat) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(std::fs::File::open(path).expect("a file")).expect("a GIF");
    let [width, height] = [decoder.width() as usize, decoder.height() as usize];
    assert!(decoder.global_palette().is_some_and(|palette| palette.len() <= 3 * 256));
    let mut shown = vec![0; 3 * width * height];
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        assert!(frame.palette.is_none(), "one palette for all");
        for (at, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] == 255) {
            let [x, y] = [at % frame.width as usize, at / frame.width as usize];
            let to = 3 * ((y + frame.top as usize) * width + x + frame.left as usize);
            shown[to..to + 3].copy_from_slice(&pixel[..3]);
        }
        frames.push((shown.clone(), frame.delay));
    }
    (frames, decoder.repeat())
}

/// The mean difference of two pictures (CIEDE2000).
fn difference(one: &[u8], other: &[u8]) -> f64 {
    use localshape::internals::{ciede2000, lab, linear};
    let of = |pixel: &[u8]| lab(linear([pixel[0], pixel[1], pixel[2]]));
    let pairs = one.chunks_exact(3).zip(other.chunks_exact(3));
    pairs.map(|(one, other)| ciede2000(of(one), of(other))).sum::<f64>() / (one.len() / 3) as f64
}

#[test]
fn an_apng_is_every_frame_to_the_bit() {
    let place = with_frames();
    let ran = place.run("animate in -o out.apng").good();
    assert!(ran.out.starts_with("out.apng  64×48, 12 pictures in 0.40 s, "), "{}", ran.out);
    let (frames, plays) = decode_apng(&place.path("out.apng"));
    assert_eq!((frames.len() as u64, plays), (COUNT, 0));
    for (number, (shown, delay)) in (0..).zip(&frames) {
        assert!(*shown == pixels(number, SIZE), "frame {number}");
        assert_eq!(*delay, 1.0 / 30.0);
    }
    let sum: u64 =
        (0..COUNT).map(|number| place.path(format!("in/frame_{number:05}.png")).metadata().unwrap().len()).sum();
    assert!(place.path("out.apng").metadata().unwrap().len() < sum);
    let bytes = std::fs::read(place.path("out.apng")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains(&format!(
        "made by localshape {}; scene {}; command: ",
        env!("CARGO_PKG_VERSION"),
        "5c".repeat(32)
    )));
    assert!(text.contains("animate in -o out.apng"));
}

#[test]
fn a_gif_looks_like_its_frames_and_keeps_their_times() {
    let place = with_frames();
    place.run("animate in -o out.gif --loop 3").good();
    let (frames, repeat) = decode_gif(&place.path("out.gif"));
    assert_eq!((frames.len() as u64, repeat), (COUNT, gif::Repeat::Finite(2)));
    for (number, (shown, _)) in (0..).zip(&frames) {
        let apart = difference(shown, &pixels(number, SIZE));
        assert!(apart < 1.0, "frame {number}: {apart}");
    }
    let delays: Vec<_> = frames.iter().map(|(_, delay)| *delay).collect();
    assert_eq!(delays, [3, 4, 3, 3, 4, 3, 3, 4, 3, 3, 4, 3]);
    // At twice the speed there are more frames than hundredths of a second.
    let ran = place.run("animate in -o out.gif --speed 2").good();
    assert!(ran.out.contains("6 pictures of 12 frames in 0.20 s"), "{}", ran.out);
    let (frames, repeat) = decode_gif(&place.path("out.gif"));
    assert!(frames.iter().all(|(_, delay)| *delay >= 2) && repeat == gif::Repeat::Infinite);
    assert!(difference(&frames.last().unwrap().0, &pixels(COUNT - 2, SIZE)) < 1.0, "every second one is shown");
    assert!(std::fs::read(place.path("out.gif")).unwrap().windows(8).any(|part| part == b"scene 5c"));
}

/// Unmoved pixels have the same colours in every frame.
#[test]
fn nothing_flickers_where_nothing_moves() {
    let place = with_frames();
    place.run("animate in -o out.gif").good();
    let (frames, _) = decode_gif(&place.path("out.gif"));
    let below = 3 * 64 * 20;
    assert!(frames.iter().all(|(shown, _)| shown[below..] == frames[0].0[below..]));
}

/// The library is called, as the comment of a file has the command, and with it the number of threads.
#[test]
fn any_number_of_threads_makes_the_same_bytes() {
    let place = Place::new();
    let moments: Vec<_> = (0..COUNT).map(|number| (number, number as f64 / 30.0)).collect();
    let mut endings = vec!["gif", "apng"];
    if has_ffmpeg() {
        endings.extend(["mp4", "webm"]);
    }
    for ending in endings {
        let path = place.path(format!("out.{ending}"));
        let made = |threads: usize| {
            let animation = Animation {
                size: SIZE,
                image: &|frame| Ok(Image { size: SIZE, pixels: pixels(frame as u64, SIZE) }),
                timeline: &Timeline::of(&moments),
                plays: 0,
                comment: "made by a test",
                threads,
                progress: &|_| {},
                go_on: &|| true,
            };
            animation.write(Format::of(&path).unwrap(), &path).unwrap();
            std::fs::read(&path).unwrap()
        };
        let one = made(1);
        for threads in [2, 3, 8] {
            assert!(one == made(threads), "{ending}, {threads} threads");
        }
    }
}

/// The animation is the same with frames kept or not.
#[test]
fn rendering_makes_animations_meanwhile() {
    let Some(place) = crate::cli::render::place_to_draw() else { return };
    let ran = place.run("render small.toml --animate a.gif --animate a.apng").good();
    for line in ["a.gif  96×64, 4 pictures of 7 frames in 0.13 s", "a.apng  96×64, 7 pictures in 0.12 s"] {
        assert!(ran.out.contains(line), "{line}: {}", ran.out);
    }
    place.run("animate output/small -o b.apng").good();
    let ran = place.run("render small.toml --animate c.apng --no-frames -o numbers").good();
    assert!(ran.out.contains("7 frames simulated in numbers"), "{}", ran.out);
    assert_eq!(place.names("numbers"), ["diagnostics.csv", "run.json"]);
    let (frames, _) = decode_apng(&place.path("a.apng"));
    assert_eq!(frames.len(), SMALL_FRAMES);
    assert!(frames == decode_apng(&place.path("b.apng")).0 && frames == decode_apng(&place.path("c.apng")).0);
    assert_eq!(decode_gif(&place.path("a.gif")).0.len(), 4);

    place.write("other.toml", SMALL);
    place.run("render small.toml other.toml --animate d.gif").bad(2, &["--animate", "one at a time"]);
    place.run("render small.toml --animate d.avi").bad(2, &[".avi", ".gif"]);
    place.run("render small.toml --animate d.gif --animate ./d.gif").bad(2, &["--animate is given ./d.gif twice"]);
    place.run("render small.toml --animate absent/d.gif").bad(2, &["there is no folder absent"]);
    assert_eq!(place.run("render small.toml --no-frames").status, Some(2));
    assert!(place.names(".").iter().all(|name| !name.starts_with("d.")));
}

/// Existing frames are kept, and the command that makes an animation of them is reported.
#[cfg(unix)]
#[test]
fn an_interrupted_rendering_makes_no_animation() {
    use crate::cli::interrupt::{signal, start};
    let Some(place) = crate::cli::render::place_to_draw() else { return };
    place.write("long.toml", &lasting("100"));
    let arguments = "render long.toml --animate a.gif --animate b.apng";
    let running = start(&place, arguments, "output/long/frame_00001.png");
    signal(&running, &["INT"]);
    let ran = running.wait();
    assert!(ran.status == Some(130) && ran.err.is_empty(), "{ran:?}");
    for name in ["a.gif", "b.apng"] {
        let command = format!("animate output/long -o {name}");
        let told =
            format!("{name}  not made, because frames are missing; to make it from the others: localshape {command}\n");
        assert!(ran.out.contains(&told), "{}", ran.out);
        assert!(!place.path(name).exists());
        place.run(&command).good();
    }
    let running = start(&place, &format!("{arguments} --overwrite --no-frames -o other"), "other/run.json");
    signal(&running, &["INT"]);
    let ran = running.wait();
    assert!(ran.out.contains("a.gif  not made, because frames are missing\n"), "{ran:?}");
}

#[test]
fn speed_rate_and_pauses() {
    let place = with_frames();
    let times = |arguments: &str| {
        place.run(&format!("animate in -o out.apng {arguments}")).good();
        let (frames, plays) = decode_apng(&place.path("out.apng"));
        let which =
            |shown: &Vec<u8>| (0..COUNT).find(|&number| *shown == pixels(number, SIZE)).expect("one of the frames");
        let shots: Vec<_> = frames.iter().map(|(shown, delay)| (which(shown), (delay * 1e4).round() / 1e4)).collect();
        (shots, plays)
    };
    assert_eq!(times("--frames 3-9x3 --speed 0.5").0, [(3, 0.2), (6, 0.2), (9, 0.2)]);
    assert_eq!(
        times("--frames 0-3 --hold-last 1.5 --loop 1"),
        (vec![(0, 0.0333), (1, 0.0333), (2, 0.0333), (3, 1.5333)], 1)
    );
    assert_eq!(times("--frames 0-8 --fps 10").0, [(0, 0.1), (3, 0.1), (6, 0.1)]);
    assert_eq!(times("--frames 1,2,8").0, [(1, 0.0333), (2, 0.2), (8, 0.2)]);
}

/// A frame may be held for any time, in formats whose delays have 16 bits.
#[test]
fn a_long_hold_keeps_its_duration() {
    let place = with_frames();
    let ran = place.run("animate in -o out.gif --frames 0-3 --hold-last 700").good();
    assert!(ran.out.contains("4 pictures in 700.13 s"), "{}", ran.out);
    let (frames, _) = decode_gif(&place.path("out.gif"));
    assert_eq!(frames.iter().map(|(_, delay)| u64::from(*delay)).sum::<u64>(), 70_013);
    assert!(frames[3..].iter().all(|(shown, _)| *shown == frames[3].0));
    place.run("animate in -o out.apng --frames 0-3 --hold-last 700").good();
    let (frames, _) = decode_apng(&place.path("out.apng"));
    let duration = frames.iter().map(|(_, delay)| delay).sum::<f64>();
    assert!((duration - 700.0 - 4.0 / 30.0).abs() < 1e-3, "{duration}");
}

#[test]
fn frames_may_be_scaled() {
    let place = with_frames();
    place.run("animate in --width 32 -o out.apng --frames 0-1").good();
    let small = &decode_apng(&place.path("out.apng")).0[1].0;
    assert_eq!(small.len(), 3 * 32 * 24);
    // Far from the square there is a vertical colour gradient.
    let below = &small[3 * 32 * 20..3 * 32 * 20 + 3];
    assert!(below[0].abs_diff(250 - 40) <= 2 && below[2] == 240, "{below:?}");
    place.write("tall/frame_00000.png", &frame_file([16, 480], &[9; 3 * 16 * 480], &tags(0)));
    bad(&place, "tall --width 1000 -o out.gif", &["1000×30000 pixels", "at most 16384 a side"]);
}

/// A folder with a script as `ffmpeg`, and the command that uses it.
#[cfg(unix)]
fn with_script(place: &Place, script: &str, arguments: &str) -> Command {
    use std::os::unix::fs::PermissionsExt;
    place.write("bin/ffmpeg", &format!("#!/bin/sh\nPATH=/usr/bin:/bin\n{script}\n"));
    std::fs::set_permissions(place.path("bin/ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = place.command(arguments.split(' '));
    command.env("PATH", place.path("bin"));
    command
}

#[cfg(unix)]
#[test]
fn films_are_piped_to_ffmpeg() {
    let place = with_frames();
    let script = "echo \"$@\" > arguments; cat > pixels; for last; do :; done; echo film > \"$last\"";
    let ran = run(&mut with_script(&place, script, "animate in -o out.mp4 --hold-last 0.1")).good();
    assert!(ran.out.starts_with("out.mp4  64×48, 15 pictures of 12 frames in 0.50 s"), "{}", ran.out);
    let arguments = place.read("arguments");
    for part in [
        "-f rawvideo",
        "rgb24",
        "64x48",
        "-framerate 30/1",
        "libx264",
        "yuv420p",
        "+faststart",
        "bt709",
        "comment=made by localshape",
    ] {
        assert!(arguments.contains(part), "{part}: {arguments}");
    }
    let raw = std::fs::read(place.path("pixels")).unwrap();
    let frames: Vec<_> = raw.chunks(3 * 64 * 48).collect();
    assert_eq!(frames.len(), 15);
    assert!(frames[..12].iter().zip(0..).all(|(frame, number)| *frame == pixels(number, SIZE)));
    assert!(frames[12..].iter().all(|frame| *frame == frames[11]));
    assert_eq!(place.read("out.mp4"), "film\n");
    run(&mut with_script(&place, script, "animate in -o out.webm")).good();
    assert!(place.read("arguments").contains("libvpx-vp9"));
}

/// Sides are made even by extending the background, and this is reported.
#[cfg(unix)]
#[test]
fn films_of_odd_frames_are_padded() {
    let place = Place::new();
    (0..3)
        .for_each(|number| put(&place, "odd", number, &frame_file([63, 47], &pixels(number, [63, 47]), &tags(number))));
    let script = "cat > pixels; for last; do :; done; echo film > \"$last\"";
    let ran = run(&mut with_script(&place, script, "animate odd -o out.mp4")).good();
    assert!(ran.out.starts_with("out.mp4  64×48, 3 pictures"), "{}", ran.out);
    let ran = run(&mut with_script(&place, script, "animate odd -o out.webm --json")).good();
    assert_eq!(ran.json()["size"], serde_json::json!([64, 48]));
    let raw = std::fs::read(place.path("pixels")).unwrap();
    assert_eq!(raw.len(), 3 * 3 * 64 * 48);
    let row = &raw[..3 * 64];
    assert!(row[..3 * 63] == pixels(0, [63, 47])[..3 * 63] && row[3 * 63..] == row[..3]);
}

#[cfg(unix)]
#[test]
fn an_ffmpeg_that_is_missing_or_fails_is_told() {
    let place = with_frames();
    let mut without = place.command(["animate", "in", "-o", "out.mp4"]);
    without.env("PATH", place.path("in"));
    run(&mut without).bad(2, &["no `ffmpeg`", ".mp4", "apt install ffmpeg", ".gif or .apng"]);
    for script in [
        "head -c 10000 > /dev/null; for n in 1 2 3 4 5 6 7; do echo \"complaint $n\" >&2; done; exit 3",
        "cat > /dev/null; for last; do :; done; echo begun > \"$last\"; for n in 3 4 5 6 7; do echo \"complaint $n\" >&2; done; exit 3",
    ] {
        let ran = run(&mut with_script(&place, script, "animate in -o out.mp4"));
        let ran = ran.bad(4, &["ffmpeg failed (exit status: 3)", "\n  complaint 3\n", "complaint 7"]);
        assert!(!ran.err.contains("complaint 2"), "the last lines only: {}", ran.err);
    }
    // Some versions exit with success on a full disk, but the film cannot be played.
    let script = "cat > /dev/null; for last; do :; done; echo cut > \"$last\"; echo 'Error writing trailer of it' >&2";
    let ran = run(&mut with_script(&place, script, "animate in -o out.mp4"));
    ran.bad(4, &["ffmpeg failed", "Error writing trailer of it"]);
    assert_eq!(place.names("."), ["bin", "in"], "nothing half-written");
}

#[cfg(unix)]
#[test]
fn an_interrupted_film_leaves_nothing() {
    use crate::cli::interrupt::{set_signals, signal};
    use crate::cli::support::Running;
    for script in [
        "echo > started; cat > /dev/null",
        // It reads no pictures, and neither does its child process.
        "echo > started; exec sleep 60",
        "echo > started; sleep 60",
        // It has read all pictures and does not end.
        "cat > /dev/null; echo > started; sleep 60",
    ] {
        let place = with_frames();
        let mut command = with_script(&place, script, "animate in -o out.mp4 --hold-last 60");
        set_signals(&mut command, &[]);
        let mut running = Running::start(&mut command);
        running.until("the start of the film", |_| place.path("started").exists());
        signal(&running, &["INT"]);
        let ran = running.wait();
        assert_eq!((ran.status, ran.err.as_str()), (Some(130), ""), "{script}: {ran:?}");
        assert_eq!(place.names("."), ["bin", "in", "started"], "{script}");
    }
}

/// The real `ffmpeg`, if it exists: the film has the right pictures at the right times.
#[test]
fn films_and_all_else_are_read_by_other_programs() {
    let place = with_frames();
    if !has_ffmpeg() {
        return;
    }
    let mut odd = Vec::new();
    for number in 0..COUNT {
        put(&place, "odd", number, &frame_file([63, 47], &pixels(number, [63, 47]), &tags(number)));
        odd.push(pixels(number, [63, 47]));
    }
    for (file, size) in [("a.mp4", [64, 48]), ("a.webm", [64, 48]), ("a.gif", [63, 47]), ("a.apng", [63, 47])] {
        let ran = place.run(&format!("animate odd -o {file}")).good();
        assert!(ran.out.starts_with(&format!("{file}  {}×{}, 12 pictures in 0.40 s", size[0], size[1])), "{}", ran.out);
        // The file is recognised as one of this program, and replaced.
        place.run(&format!("animate odd -o {file} --frames 0-3")).good();
        place.run(&format!("animate odd -o {file}")).good();
        let mut decoder = Command::new("ffmpeg");
        decoder.args(["-v", "error", "-i", file, "-vf", "scale=in_color_matrix=bt709", "-vsync", "0"]);
        decoder.args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]).current_dir(place.path("."));
        let output = decoder.output().expect("ffmpeg starts");
        assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
        let [width, height] = size.map(|side| side as usize);
        let frames: Vec<_> = output.stdout.chunks(3 * width * height).collect();
        assert_eq!(frames.len() as u64, COUNT, "{file}");
        for (shown, number) in frames.iter().zip(0..) {
            let inner =
                shown.chunks_exact(3 * width).take(47).flat_map(|row| &row[..3 * 63]).copied().collect::<Vec<u8>>();
            let apart = difference(&inner, &odd[number]);
            assert!(apart < 3.0, "{file}, frame {number}: {apart}");
        }
        if size != [63, 47] {
            // Four pixels share a colour, but each has its own luma: here the luma of the background.
            let corner = &frames[0][frames[0].len() - 3 * width..][..3];
            let brightness =
                0.2126 * f64::from(corner[0]) + 0.7152 * f64::from(corner[1]) + 0.0722 * f64::from(corner[2]);
            assert!((brightness - 249.3).abs() < 4.0, "{file}: {corner:?}");
        }
        let mut prober = Command::new("ffprobe");
        prober.args([
            "-v",
            "error",
            "-show_entries",
            "stream=pix_fmt,color_space,r_frame_rate:format_tags=comment",
            file,
        ]);
        let Ok(output) = prober.current_dir(place.path(".")).output() else { continue };
        let told = String::from_utf8_lossy(&output.stdout);
        if file == "a.mp4" || file == "a.webm" {
            for part in ["yuv420p", "bt709", "r_frame_rate=30/1", "made by localshape"] {
                assert!(told.contains(part), "{file}, {part}: {told}");
            }
        }
    }
}

#[test]
fn pillow_reads_the_same() {
    let place = with_frames();
    let Some(python) = python("PIL") else { return };
    place.run("animate in -o a.gif").good();
    place.run("animate in -o a.apng").good();
    let script = "
import sys
from PIL import Image, ImageChops
for name in ['a.gif', 'a.apng']:
    film = Image.open(name)
    assert film.n_frames == 12, film.n_frames
    total = 0
    for number in range(12):
        film.seek(number)
        total += film.info['duration']
        original = Image.open(f'in/frame_{number:05}.png').convert('RGB')
        apart = max(high for _, high in ImageChops.difference(film.convert('RGB'), original).getextrema())
        assert apart <= (0 if name == 'a.apng' else 24), (name, number, apart)
    assert abs(total - 400) < 1, total
print('fine')
";
    assert_eq!(python(&place.path("."), script), "fine\n");
}

/// One second at 60 frames a second has 61 frames, of which players show half in a GIF.
#[test]
fn durations_are_those_of_the_frames() {
    let place = Place::new();
    for number in 0..=60 {
        put(&place, "in", number, &frame_file(SIZE, &pixels(number, SIZE), &frame_tags(number, number as f64 / 60.0)));
    }
    for (arguments, words) in [
        ("out.gif", "31 pictures of 61 frames in 1.03 s"),
        ("out.apng", "61 pictures in 1.02 s"),
        ("out.apng --speed 0.25 --hold-last 1.5", "61 pictures in 5.57 s"),
        ("out.apng --frames 7", "1 picture in 1.00 s"),
    ] {
        let ran = place.run(&format!("animate in -o {arguments}")).good();
        assert!(ran.out.contains(words), "{words}: {}", ran.out);
    }
}

/// Names with what shells, patterns and browsers read.
#[cfg(unix)]
#[test]
fn odd_paths_are_names_like_others() {
    let place = Place::new();
    let folder = "100%d & \"q\" ü/-x/out%05d";
    (0..6).for_each(|number| put(&place, folder, number, &frame_file(SIZE, &pixels(number, SIZE), &tags(number))));
    for file in ["m%03d.apng", "a%d:b.gif", "a%d:b.mp4"] {
        if file.ends_with("mp4") && !has_ffmpeg() {
            continue;
        }
        let ran = run(&mut place.command(["animate", folder, "-o", file])).good();
        assert!(ran.out.contains("6 pictures in 0.20 s") && place.path(file).is_file(), "{file}: {}", ran.out);
    }
}

/// Numbered pictures of another program are frames at a given rate, on white where they are transparent.
#[test]
fn frames_of_other_programs_have_the_rate_that_is_given() {
    let place = Place::new();
    let file = |number: u64| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, SIZE[0], SIZE[1]);
        encoder.set_color(png::ColorType::Rgba);
        let opaque = |pixel: &[u8]| [pixel[0], pixel[1], pixel[2], 255];
        let all: Vec<u8> = pixels(number, SIZE).chunks_exact(3).flat_map(opaque).collect();
        encoder.write_header().unwrap().write_image_data(&all).unwrap();
        bytes
    };
    (1..=6).for_each(|number| place.write(&format!("other/render.{number:04}.png"), &file(number)));
    // Cameras and programs on Windows write capital letters.
    (1..=6).for_each(|number| place.write(&format!("capitals/DSC{number:04}.PNG"), &file(number)));
    let ran = place.run("animate capitals -o capitals.apng --fps 30").good();
    assert!(ran.out.starts_with("capitals.apng  64×48, 6 pictures in 0.20 s, "), "{}", ran.out);
    bad(
        &place,
        "other -o out.apng",
        &["other has frames of another program, such as render.0001.png, which carry no times; add --fps"],
    );
    let ran = place.run("animate other -o out.apng --fps 29.97").good();
    assert!(ran.out.starts_with("out.apng  64×48, 6 pictures in 0.20 s, "), "{}", ran.out);
    let (frames, _) = decode_apng(&place.path("out.apng"));
    assert_eq!(frames.len(), 6);
    for (number, (shown, delay)) in (1..).zip(&frames) {
        assert!(*shown == pixels(number, SIZE), "frame {number}");
        assert!((delay * 29.97 - 1.0).abs() < 1e-6, "{delay}");
    }
    // Slow motion shows each frame twice; a part of the frames has no longer pauses.
    let ran = place.run("animate other -o out.apng --fps 30 --speed 0.5 --overwrite").good();
    assert!(ran.out.contains("6 pictures in 0.40 s"), "{}", ran.out);
    let ran = place.run("animate other -o out.apng --fps 30 --frames 1,4,6").good();
    assert!(ran.out.contains("3 pictures in 0.10 s"), "{}", ran.out);
    bad(&place, "other -o out.apng --fps 30 --frames 0-6", &["frames of other: there is no frame 0"]);
    std::fs::remove_file(place.path("other/render.0003.png")).unwrap();
    bad(&place, "other -o out.apng --fps 30", &["other has a gap: render.0004.png follows render.0002.png"]);
    place.write("other/render.0003.png", &frame_file([32, 48], &pixels(2, [32, 48]), &tags(2)));
    bad(&place, "other -o out.apng --fps 30", &["other/render.0003.png has 32×48 pixels, render.0002.png has 64×48"]);
    place.write("other/render.0003.png", b"GIF89a");
    bad(&place, "other -o out.apng --fps 30", &["other/render.0003.png is damaged, or is not a PNG picture"]);
    place.write("other/left.0003.png", &file(3));
    bad(&place, "other -o out.apng --fps 30", &["other has several sequences, left.… and render.…"]);
    // As file managers number them, and without numbers.
    (1..=3).for_each(|number| place.write(&format!("copies/Frame ({number}).png"), &file(number)));
    let ran = place.run("animate copies -o copies.apng --fps 30").good();
    assert!(ran.out.contains("3 pictures in 0.10 s"), "{}", ran.out);
    place.write("plain/left.png", &file(1));
    bad(&place, "plain -o out.apng --fps 30", &["plain has no frames", "number at the end of their names"]);
}

fn bad(place: &Place, arguments: &str, words: &[&str]) -> Ran {
    place.run(&format!("animate {arguments}")).bad(2, words)
}

#[test]
fn frames_that_are_no_sequence_are_told() {
    let place = with_frames();
    let copy = |name: &str| {
        (0..4).for_each(|number| put(&place, name, number, &frame_file(SIZE, &pixels(number, SIZE), &tags(number))))
    };
    place.write("empty/notes.txt", "");
    bad(&place, "empty -o out.gif", &["empty has no frames", "localshape render"]);
    bad(&place, "absent -o out.gif", &["absent", "expected a folder with frames"]);
    bad(&place, "empty/notes.txt -o out.gif", &["is not a folder"]);
    copy("gap");
    std::fs::remove_file(place.path("gap/frame_00002.png")).unwrap();
    bad(&place, "gap -o out.gif", &["gap has a gap: frame_00003.png follows frame_00001.png", "--frames"]);
    bad(&place, "gap -o out.gif --frames 0-3", &["there is no frame_00002.png"]);
    bad(&place, "gap -o out.gif --frames 0-7", &["there is no frame 7"]);
    place.run("animate gap -o fine.gif --frames 0,1,3").good();
    let with = |name: &str, bytes: &[u8]| {
        copy(name);
        put(&place, name, 2, bytes);
    };
    with("size", &frame_file([32, 48], &pixels(2, [32, 48]), &tags(2)));
    bad(&place, "size -o out.gif", &["size/frame_00002.png has 32×48 pixels, frame_00001.png has 64×48"]);
    with("scene", &frame_file(SIZE, &pixels(2, SIZE), &Tags { scenes: vec!["99".repeat(32)], ..tags(2) }));
    bad(&place, "scene -o out.gif", &["scene/frame_00002.png shows a different scene than frame_00001.png"]);
    with(
        "runs",
        &frame_file(SIZE, &pixels(2, SIZE), &Tags { states: vec![("ab".repeat(32), "Springs".to_owned())], ..tags(2) }),
    );
    bad(&place, "runs -o out.gif", &["runs/frame_00002.png shows the runs “Springs”", "“Local shape”"]);
    with("time", &frame_file(SIZE, &pixels(2, SIZE), &Tags { shows: Shown::Frame { frame: 2, time: 0.0 }, ..tags(2) }));
    bad(&place, "time -o out.gif", &["time/frame_00002.png is at 0 s, not after frame_00001.png"]);
    with("renamed", &frame_file(SIZE, &pixels(2, SIZE), &tags(3)));
    bad(&place, "renamed -o out.gif", &["renamed/frame_00002.png shows frame 3"]);
    with("foreign", b"GIF89a");
    bad(&place, "foreign -o out.gif", &["foreign/frame_00002.png is damaged, or is not a frame"]);
    let whole = frame_file(SIZE, &pixels(2, SIZE), &tags(2));
    with("cut", &whole[..whole.len() - 40]);
    for out in ["out.gif", "out.apng"] {
        bad(&place, &format!("cut -o {out}"), &["cut/frame_00002.png: this PNG picture is damaged or cut short"]);
    }
    assert!(
        place.names(".").iter().all(|name| !name.starts_with("out") && !name.starts_with('.')),
        "nothing half-written"
    );
}

#[test]
fn wrong_options_are_told() {
    let place = with_frames();
    for (arguments, words) in [
        ("in -o out.avi", [".avi", ".gif, .apng, .mp4 or .webm"]),
        ("in -o out", ["no ending", ".gif"]),
        ("in -o out.png", [".png", "localshape figure"]),
        ("in -o in", ["no ending", ".gif"]),
        ("in -o out.mp4 --loop 0", ["--loop is for .gif and .apng", "the player"]),
    ] {
        bad(&place, arguments, &words);
    }
    for (arguments, word) in [
        ("--speed 0", "0.001 to 1000"),
        ("--speed -1", "0.001 to 1000"),
        ("--speed nan", "0.001 to 1000"),
        ("--fps 0", "0.1 to 1000"),
        ("--hold-last -1", "0 to 3600"),
        ("--width 3", "16"),
        ("--loop -1", "1 to 65535, or 0 for endless"),
        ("--loop forever", "1 to 65535, or 0 for endless"),
        ("--frames 9-0", "did you mean 0-9?"),
    ] {
        let ran = place.run(&format!("animate in -o out.gif {arguments}"));
        assert!(ran.status == Some(2) && ran.err.contains(word), "{arguments}: {ran:?}");
    }
    for (name, text) in [
        ("mine.gif", "made by localshape 0.1.0"),
        ("mine.gif", "GIF89a, not made by localshape 0.1.0 but by hand, with a long text"),
        ("mine.gif", "GIF89a..!\u{fe}.made by localshape by hand"),
        ("mine.apng", "\u{89}PNG\r\n\u{1a}\n....tEXtNote\0made by localshape 0.1.0"),
        ("mine.mp4", "....ftypisom. It was not made by localshape 0.1.0"),
        ("mine.webm", "made by localshape 0.1.0"),
    ] {
        // One byte for each letter.
        let bytes: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
        std::fs::write(place.path(name), &bytes).unwrap();
        bad(&place, &format!("in -o {name}"), &[&format!("{name} exists and was not made"), "--overwrite"]);
        assert!(std::fs::read(place.path(name)).unwrap() == bytes);
    }
    for name in ["mine.gif", "mine.apng"] {
        place.run(&format!("animate in -o {name} --overwrite")).good();
        place.run(&format!("animate in -o {name}")).good();
    }
    std::fs::create_dir(place.path("folder.gif")).unwrap();
    bad(&place, "in -o folder.gif", &["folder.gif is not a file"]);
    place.run("animate in -o absent/out.gif").bad(4, &["cannot write absent/out.gif"]);
}

#[test]
fn summaries_are_documents_if_asked_for() {
    let place = with_frames();
    let made = place.run("animate in -o out.gif --json").good().json();
    assert_eq!(
        (made["file"].as_str(), made["pictures"].as_u64(), made["frames"].as_u64()),
        (Some("out.gif"), Some(12), Some(12))
    );
    assert_eq!(made["bytes"].as_u64(), Some(place.path("out.gif").metadata().unwrap().len()));
    assert_eq!(place.run("animate in -o out.gif -q").good().out, "");
}
