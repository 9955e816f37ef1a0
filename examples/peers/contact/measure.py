"""Measures recordings of any engine by the same figures and prints a table for each scene."""

import sys
from pathlib import Path

import numpy as np

from recording import CELL, Recording


def head(names):
    print(f"| engine, setting | {names} |\n|---|{'---|' * len(names.split(' | '))}")


def row(recording, *cells):
    print(f"| {recording.engine}, {recording.setting} |", " | ".join(cells), "|", flush=True)


def turned(recordings):
    return f"{max(r.turned_over for r in recordings)} / {max(r.turned_at_end for r in recordings)} of {recordings[0].elements}"


def head_on(recordings):
    head("momentum | angular momentum | energy kept | deepest node (mm) | crossing pairs | turned over | time (s)")
    for r in recordings:
        momentum, angular, energy = r.changes()
        row(r, f"{momentum:.1e}", f"{angular:.1e}", f"{energy:.2f}", f"{1e3 * r.depth():.2f}", f"{r.crossings().max()}",
            turned([r]), f"{r.seconds:.2f}")


def impacts(recordings):
    head("impacts | NaN | ever crossing | crossing at the end | momentum | angular momentum | energy kept | turned over")
    for key in dict.fromkeys((r.engine, r.setting) for r in recordings):
        all_of = [r for r in recordings if (r.engine, r.setting) == key]
        ended = [r for r in all_of if r.finite.all()]
        crossings = [r.crossings() for r in all_of]
        changes = np.max([r.changes() for r in ended], axis=0) if ended else [np.nan] * 3
        row(all_of[0], f"{len(all_of)}", f"{len(all_of) - len(ended)}", f"{sum(c.max() > 0 for c in crossings)}",
            f"{sum(c[-1] > 0 for c in crossings)}", f"{changes[0]:.1e}", f"{changes[1]:.1e}", f"{changes[2]:.2f}", turned(all_of))


def pressed(recordings):
    head("deepest in the rod (mm) | axis inside | turned over | time (s)")
    for r in recordings:
        deepest, share = r.rod()
        row(r, f"{1e3 * max(0, deepest):.2f}", f"{share:.2f}", turned([r]), f"{r.seconds:.2f}")


def wall(recordings):
    head("until (s) | top moves (cells) | sideways (cells) | sinks into the floor (mm) | deepest node (mm) | crossing pairs | turned over")
    for r in recordings:
        centres = np.array([r.position[:, r.body == body].mean(axis=1) for body in range(10)])[:, r.finite]
        late = r.time[r.finite] >= r.time[-1] / 2
        top, sideways = np.ptp(centres[9, late, 1]), np.linalg.norm((centres - centres[:, :1])[..., [0, 2]], axis=-1).max()
        sinks = max(0, -1e3 * r.position[r.finite][..., 1].min())
        row(r, f"{r.time[-1]:.2f}" + ("" if r.finite.all() else " NaN"), f"{top / CELL:.4f}", f"{sideways / CELL:.3f}", f"{sinks:.2f}",
            f"{1e3 * r.depth(every=10):.2f}", f"{r.crossings().max()}", turned([r]))


def cost(recordings, walls):
    head("step (ms) | processor time of a step apart (ms) | in the wall (ms) | ratio | of a simulated second in the wall (s)")
    for r in recordings:
        for w in walls:
            if (w.engine, w.setting) == (r.engine, r.setting) and w.finite.all():
                apart, together = r.seconds / r.time[-1], w.seconds / w.time[-1]
                row(r, f"{1e3 * r.step:.3g}", f"{1e3 * apart * r.step:.2f}", f"{1e3 * together * r.step:.2f}",
                    f"{together / apart:.1f}", f"{together:.1f}")


recordings = [Recording(Path(file)) for file in sys.argv[1:]]
scenes = {"head-on": head_on, "impact": impacts, "rod": pressed, "wall": wall}
for name, table in scenes.items():
    of_scene = [r for r in recordings if r.scene.startswith(name)]
    if of_scene:
        print(f"\n## {name}")
        table(of_scene)
if any(r.scene == "apart" for r in recordings):
    print("\n## apart")
    cost([r for r in recordings if r.scene == "apart"], [r for r in recordings if r.scene == "wall"])
