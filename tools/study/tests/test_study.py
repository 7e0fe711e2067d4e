"""The study kit: orders, answers, files, intervals, and the page. Tests that draw need the program (`BELVEDERE` or on
the path), those of the page's own program need Node; without them they are skipped."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any, Sequence

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from belvedere_study import analysis, fit, masks, order, page, records, routes, simulate, stimuli, student, texts
from belvedere_study.choosing import Views, counted, sought
from belvedere_study.setting import Bend, Setting
from belvedere_study.survey import Town
from belvedere_study.things import Thing
from belvedere_study.trying import Unsuitable

SCENES = {"find": 8, "count": 6, "path": 6}
#: Looks like a picture as far as the page is concerned.
PNG = b"\x89PNG\r\n\x1a\n" + bytes(20)


# Orders


def test_every_scene_meets_every_condition_and_place_equally_often() -> None:
    for length, rows in order.table(SCENES, 10).items():
        met: Counter[tuple[int, ...]] = Counter()
        for row in rows:
            blocks: dict[int, list[order.Trial]] = {}
            for trial in row["a"]:
                blocks.setdefault(trial[0], []).append(trial)
            for task, trials in blocks.items():
                assert sorted(trial[1] for trial in trials) == list(range(len(trials))), "each scene once"
                assert 2 * sum(trial[2] for trial in trials) == len(trials), "half of them bent"
                met.update((task, place, trial[1], trial[2]) for place, trial in enumerate(trials))
        for task in range(3):
            counts = {met[key] for key in met if key[0] == task}
            scenes = len({key[2] for key in met if key[0] == task})
            assert counts == {order.ROWS // scenes // 2}, (length, task)
            assert len([key for key in met if key[0] == task]) == 2 * scenes**2


def test_tasks_take_turns_and_scenes_follow_each_other_evenly() -> None:
    rows = order.table(SCENES, 10)["full"]
    assert Counter(row["a"][0][0] for row in rows) == {0: 80, 1: 80, 2: 80}
    for n in (2, 4, 6, 8):
        pairs = Counter(pair for line in order.latin(n) for pair in zip(line, line[1:]))
        assert set(pairs.values()) == {1} and len(pairs) == n * (n - 1)


def test_every_pair_is_shown_equally_often_and_on_both_sides() -> None:
    for length, rows in order.table(SCENES, 10).items():
        shown = Counter(tuple(trial[1:]) for row in rows for trial in row["b"])
        assert len(shown) == 120 and len(set(shown.values())) == 1, length
        for row in rows:
            pairs = [(trial[1], *sorted(trial[2:])) for trial in row["b"]]
            assert len(set(pairs)) == len(pairs) == order.PAIRS_EACH[length]
            perspectives = Counter(tuple(sorted(trial[2:])) for trial in row["b"])
            assert max(perspectives.values()) - min(perspectives.values()) <= 1


def test_small_kits_have_orders_too() -> None:
    rows = order.table({"find": 2, "count": 2, "path": 2}, 2)["full"]
    assert all(len(row["a"]) == 6 and len(row["b"]) == 12 for row in rows)


# Answers


def _setting(n: int) -> Setting:
    things = [Thing("car" if k % 2 else "bus", (float(k), 0.0, 0.0)) for k in range(n)]
    bend = Bend(0, 1, (1, 2, 3))
    return Setting("city", [{}] * 4, things, [(0.0, 0.0, 0.0)] * 3, (0.0, 1.0, 0.0), 40.0, bend, (64, 40))


def test_what_is_sought_is_the_only_one_of_its_colour_and_can_be_found_in_both() -> None:
    px = np.zeros((2, 3, 12))
    px[:, 0, 3] = 50
    px[0, 1, 5], px[1, :, 5] = 100, 100
    px[1, :, 7] = 900
    views, rng = Views(px, 1), np.random.default_rng(1)
    for _ in range(20):
        target, *others = sought(rng, _setting(12), views, hidden=True)
        assert target.at[0] == 3.0, "5 is seen at the start, 7 is never seen straight"
        assert target.colour not in {other.colour for other in others}
    with pytest.raises(Unsuitable):
        sought(rng, _setting(12), Views(np.zeros((2, 3, 12)), 1), hidden=False)


def test_what_is_counted_is_all_there_is_of_its_colour() -> None:
    px = np.full((2, 3, 20), 60.0)
    px[0, 1, ::3] = 0
    for seed in range(20):
        amount, things = counted(np.random.default_rng(seed), _setting(20), Views(px, 1), 4, 7)
        same = [thing for thing in things if thing.colour == things[0].colour]
        assert same == things[:amount] and len({thing.what for thing in same}) == 1
        assert sum(px[0, 1, int(thing.at[0])] == 0 for thing in same) * 3 >= amount


def test_clicks_hit_a_thing_and_its_rim_but_no_other() -> None:
    ids = np.zeros((20, 128), int)
    ids[5:9, 20:26], ids[5:9, 27:30] = 3, 4
    found = masks.target(ids, 3, [4])
    assert masks.hit(found, 20.5, 5.5) and masks.hit(found, 19.2, 4.5) and masks.hit(found, 26.5, 6)
    assert not masks.hit(found, 27.5, 6) and not masks.hit(found, 18.5, 6) and not masks.hit(found, 22, 10.5)
    assert not masks.grown(np.eye(1, 5, 0, dtype=bool), 1)[0, -1], "nothing is rolled over the edge"


def test_maps_differ_and_none_stands_out() -> None:
    town = Town([100.0 * k for k in range(8)], [100.0 * k for k in range(8)], 0.0, 800.0)
    for seed in range(50):
        rng = np.random.default_rng(seed)
        way = routes.route(rng, town, 3, 0, 6)
        maps = routes.maps(rng, way)
        assert len({tuple(one) for one in maps}) == 4
        assert maps[0][-1] == tuple(np.subtract(way.crossings()[-1], way.crossings()[0]))

        def sides(one: routes.Map) -> list[bool]:
            return [b[0] > a[0] for a, b in zip(one, one[1:]) if a[0] != b[0]]

        apart = [sorted(sum(p != q for p, q in zip(sides(a), sides(b))) for b in maps) for a in maps]
        assert all(one == [0, 1, 1, 2] for one in apart)
        assert len(way.turns()) == 6


def test_turns_are_told_from_the_walker() -> None:
    assert routes.Route((0, 0), [(0, 1), (1, 0), (0, 1), (-1, 0), (0, 2)]).turns() == "RLLR"


# Files


def _row(**values: str) -> records.Row:
    return {**dict.fromkeys(records.COLUMNS, ""), "kit": "k", "participant": "1", "position": "1", **values}


def test_rows_come_back_from_csv() -> None:
    rows = [_row(answer='say "7", or\r\n8', scene="find-1"), _row(position="2", **{"class": "ROSE"})]
    assert records.parse(records.write(rows), "x.csv") == rows
    with pytest.raises(records.RecordError, match="column kit"):
        records.parse("a,b\r\n1,2\r\n", "other.csv")


def test_answers_count_once_and_kits_are_not_mixed(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text(records.write([_row(), _row(position="2")]), encoding="utf-8")
    found = records.read([file, file])
    assert len(found.rows) == 2 and "twice" in found.notes[0]
    with pytest.raises(records.RecordError, match="several kits"):
        records.unique(records.Records([_row(), _row(kit="other", position="2")]))


# Intervals


def test_quantiles_are_those_of_the_tables() -> None:
    for p, df, value in ((0.975, 1, 12.7062), (0.975, 10, 2.2281), (0.995, 43, 2.6951), (0.95, 5, 2.0150)):
        assert student.t_quantile(p, df) == pytest.approx(value, abs=1e-4)
    assert student.normal_hazard(np.array([0.0, 1.0, 9.0])) == pytest.approx([0.79788, 1.52514, 9.1111], abs=2e-3)


def test_intervals_hold_what_is_true_of_made_up_populations() -> None:
    found = simulate.coverage(seed=1, populations=100, people=44)
    for name, one in found.items():
        assert one["together"] >= 95, (name, one)
        # Each alone misses 5 of 100 on average; fewer than 88 held would be less than one chance in a thousand.
        assert one["alone"] >= 88, (name, one)
        assert one["mean"] == pytest.approx(one["known"], abs=0.03)


def test_times_that_were_cut_off_do_not_hide_the_effect() -> None:
    rng, table = np.random.default_rng(2), order.table(SCENES, 10)
    answers = simulate.population(rng, table, 200, simulate.Effects(time_ratio=0.4), "full")
    for row in answers.rows:
        if row["task"] == "find" and float(row["time_ms"]) > 15000:
            row.update(time_ms="15000", correct="0")
    ratio = analysis.analyse(answers)["finding"]["ratio"]
    assert ratio["low"] < 0.4 < ratio["high"] and ratio["value"] == pytest.approx(0.4, rel=0.06)


def test_jackknife_of_a_mean_is_the_interval_of_the_textbook() -> None:
    y = np.array([1.0, 2.0, 4.0, 7.0])
    sums = fit.sums(np.ones((4, 1)), y, np.arange(4), own_level=False)
    one = fit.interval(float(sums.solved()[0]), sums.without()[:, 0], 1)
    half = 3.182446 * y.std(ddof=1) / 2
    assert (one.value, one.low, one.high) == pytest.approx((3.5, 3.5 - half, 3.5 + half))


def test_one_participant_gives_no_interval_and_restarted_trials_do_not_count() -> None:
    table = order.table(SCENES, 10)
    answers = simulate.population(np.random.default_rng(3), table, 1, simulate.Effects(), "short")
    answers.rows[0]["restarted"] = "1"
    answers.rows[-1]["restarted"] = "1"
    found = analysis.analyse(answers)
    assert found["participants"] == 1 and found["finding"]["ratio"]["low"] is None
    assert "2 trials" in found["notes"][0]
    assert analysis.analyse(records.Records([_row(task="find", condition="bent", time_ms="900")]))["finding"] is None


# The page


def _kit() -> dict[str, Any]:
    def both(n: int, **more: Any) -> dict[str, Any]:
        shown = {"pictures": ["a.png", "b.png"], "targets": [[[3, 4, 9]], []], "seen_px": [[40], [0]]}
        thing = {"id": str(n), "kind": "city", "what": "car", "colour": "red", "start": 1}
        return {**thing, "straight": shown, "bent": shown, **more}

    maps = [[[0, 0], [0, 1], [side, 1]] for side in (-2, -1, 1, 2)]
    prefer = {one: {"picture": "a.png", "visible": 0.5} for one in order.PERSPECTIVES}
    tasks = {
        "find": [both(k) for k in range(4)],
        "count": [both(k, answer=3) for k in range(2)],
        "path": [both(k, maps=maps) for k in range(2)],
        "prefer": [prefer] * 3,
    }
    practice = {task: items[:1] for task, items in tasks.items()}
    limits = {"find": 90, "count": 45, "view": 1.8}
    return {"kit": "0123abcd", "size": [640, 400], "limits_s": limits, "practice": practice, **tasks}


@pytest.fixture(name="written")
def _written(tmp_path: Path) -> str:
    (tmp_path / "pictures").mkdir()
    for name in ("a.png", "b.png", "unused.png"):
        (tmp_path / "pictures" / name).write_bytes(PNG)
    return page.write(tmp_path, _kit(), texts.english()).read_text(encoding="utf-8")


def _data(text: str) -> dict[str, Any]:
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


def test_the_page_refers_to_nothing_outside(written: str) -> None:
    data = _data(written)
    assert set(data["pictures"]) == {"a.png", "b.png"}
    assert all(uri.startswith("data:image/png;base64,") for uri in data["pictures"].values())
    rest = re.sub(r"data:image/[a-z]+;base64,[A-Za-z0-9+/=]+", "", written)
    loading = ("http:", "https:", "//cdn", "@import", "url(", "<link", " src=")
    sending = ("fetch(", "XMLHttpRequest", "WebSocket", "EventSource", "sendBeacon", "<form")
    for outside in (*loading, *sending):
        assert outside not in rest, outside
    assert "default-src 'none'" in written and "<!--" not in written.replace("<!-- Nothing can", "")


def test_the_order_of_the_page_is_the_table(written: str) -> None:
    data = _data(written)
    assert data["order"] == order.of_kit(_kit()) and data["columns"] == list(records.COLUMNS)


def _script(names: Sequence[str]) -> str:
    return "\n".join((Path(page.__file__).parent / "web" / name).read_text(encoding="utf-8") for name in names)


def test_every_text_of_the_page_is_in_the_table() -> None:
    script = _script(page.SCRIPTS)
    known = texts.english()
    used = set(re.findall(r"\bt\([\"']([\w.-]+)[\"']", script))
    used |= set(re.findall(r'"((?:sum|teacher)\.[\w.]+)"', script))
    assert len(used) > 60 and not used - set(known)
    for task in order.TASKS:
        assert {f"task.{task}.title", f"task.{task}.text", f"task.{task}.ask"} <= set(known)


def test_a_translation_replaces_texts_and_slips_are_told(tmp_path: Path) -> None:
    file = tmp_path / "de.json"
    file.write_text('{"ready": "Bereit"}', encoding="utf-8")
    assert texts.table(file)["ready"] == "Bereit"
    file.write_text('{"raedy": "Bereit"}', encoding="utf-8")
    with pytest.raises(ValueError, match="raedy"):
        texts.table(file)


def _in_node(written: str, code: str) -> Any:
    """What the page's own functions answer, without its last part, which starts it."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs Node")
    before = "const document = { getElementById: () => ({ textContent: require('fs').readFileSync(0, 'utf8') }) };"
    source = f"{before}\n{_script(page.SCRIPTS[:-1])}\nconsole.log(JSON.stringify({code}));"
    data = json.dumps(_data(written))
    ran = subprocess.run([node, "-e", source], input=data, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


def test_the_page_plays_the_trials_of_the_table(written: str) -> None:
    asked = [("AB", "full", 1), ("A", "short", 7), ("B", "full", 240), ("AB", "short", 241)]
    code = f"{json.dumps(asked)}.map(([run, length, number]) => trialsOf({{ run, length, number }}))"
    table = order.of_kit(_kit())
    for (run, length, number), trials in zip(asked, _in_node(written, code)):
        row = table[length][(number - 1) % order.ROWS]
        expected = (row["a"] if "A" in run else []) + (row["b"] if "B" in run else [])
        assert len(trials) == len(expected)
        for trial, (task, scene, one, two) in zip(trials, expected):
            assert (trial["task"], trial["scene"]) == (order.TASKS[task], f"{order.TASKS[task]}-{scene + 1}")
            if task == 3:
                assert (trial["left"], trial["right"]) == (order.PERSPECTIVES[one], order.PERSPECTIVES[two])
            else:
                assert (trial["condition"], trial["shift"]) == (("straight", "bent")[one], two)


def test_codes_of_the_page_come_back_and_slips_are_told(written: str) -> None:
    code = """(() => {
      const all = [];
      for (const word of ["", "ROSE", "AB"]) for (const run of ["A", "B", "AB"]) for (const length of ["full", "short"])
        for (const number of [1, 12, 240]) all.push({ word, run, length, number });
      const made = all.map((one) => ({ ...one, code: makeCode(one) }));
      const back = made.map((one) => readCode(` ${one.code.toLowerCase()} `));
      const slips = made.map((one) => readCode(one.code.replace(/\\d/, (d) => (Number(d) + 1) % 10)));
      const swapped = made.filter((one) => one.number === 12).map((one) => readCode(one.code.replace("12", "21")));
      return { made, back, slips: [...slips, ...swapped] };
    })()"""
    found = _in_node(written, code)
    assert found["back"] == found["made"] and not any(found["slips"])


def test_csv_of_the_page_is_that_of_the_analysis(written: str) -> None:
    rows = [_row(kit="0123abcd", answer='a "b", c\nd'), _row(kit="0123abcd", position="2", x="1.5")]
    text = json.dumps(records.write(rows))
    foreign = "csvRows('a,b\\n1,2')"
    found = _in_node(written, f"{{ rows: csvRows({text}), text: csvText(csvRows({text})), foreign: {foreign} }}")
    assert found["rows"] == rows and found["text"] == records.write(rows) and found["foreign"] is None


# With the program


def test_a_small_kit_has_known_answers(tmp_path: Path) -> None:
    program = os.environ.get("BELVEDERE") or shutil.which("belvedere")
    if program is None:
        pytest.skip("needs the program: set BELVEDERE")
    kit = stimuli.make(tmp_path, program, 3, (320, 200), stimuli.QUICK, 2)
    assert kit["kit"] == json.loads((tmp_path / "stimuli.json").read_text())["kit"]
    for item in kit["find"] + kit["count"] + kit["path"]:
        for condition in ("straight", "bent"):
            assert all((tmp_path / "pictures" / name).stat().st_size > 500 for name in item[condition]["pictures"])
    for item in kit["find"] + kit["count"]:
        asked = item.get("answer", 1)
        for condition in ("straight", "bent"):
            seen = np.array(item[condition]["seen_px"])
            assert seen.shape == (3, asked) and (seen.max(axis=0) > 20).all(), "some view shows each"
    for item in kit["find"]:
        for view, (px,) in enumerate(item["bent"]["seen_px"]):
            assert bool(item["bent"]["targets"][view]) == (px > 0)
    assert max(kit["find"][0]["straight"]["seen_px"][1]) <= 6, "the first straight picture hides it"
    for item in kit["path"]:
        assert max(item["bent"]["visible"]) > max(item["straight"]["visible"])
        assert len(item["maps"]) == 4
    written = page.write(tmp_path, kit, texts.english())
    assert written.stat().st_size < 15e6
