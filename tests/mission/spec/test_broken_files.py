"""Each fault that a user can make, with one file in missions/broken and exactly what is said of it."""

import re
from pathlib import Path

import pytest
import yaml

from mission.errors import SpecError
from mission.spec import yaml_tree
from mission.spec.loader import load_mission, parse_mission
from tests.support.faults_of_places import FAULTS_OF_PLACES

BROKEN = Path(__file__).parents[3] / "missions" / "broken"

EXPECTED = [
    *FAULTS_OF_PLACES,
    # file, line, column, path, message
    ("automaton_and_formula", 8, 1, "mission", "formula and automaton exclude each other"),
    ("automaton_empty", 9, 14, "mission.automaton", "the text is empty"),
    ("automaton_is_a_directory", 9, 14, "mission.automaton", ".: this is a directory"),
    ("automaton_missing", 9, 14, "mission.automaton", "feild.hoa: there is no such file"),
    (
        "automaton_not_buchi",
        9,
        14,
        "mission.automaton",
        "not_buchi.hoa, line 7, column 15: 'Fin' is in no Büchi or generalised Büchi condition",
    ),
    (
        "automaton_not_hoa",
        9,
        14,
        "mission.automaton",
        "automaton_not_hoa.yaml, line 1, column 1: '#' has no meaning here",
    ),
    ("automaton_not_text", 9, 14, "mission.automaton", "expected text or a mapping of keys to values, found `7`"),
    ("automaton_by_hand", 9, 17, "mission.automaton.accepting[0]", "`doen` is none of the automaton's states"),
    ("automaton_by_hand", 12, 39, "mission.automaton.edges[1].when", "`F` is about more than one moment"),
    ("automaton_by_hand", 13, 38, "mission.automaton.edges[2].when", "`Feld` is no region"),
    (
        "automaton_unknown_region",
        9,
        14,
        "mission.automaton",
        "the automaton in unknown_region.hoa speaks of `Hoem`, which is no region",
    ),
    ("backslash_in_quotes", 9, 14, "", "in double quotes a backslash begins an escape"),
    ("bad_indentation", 6, 4, "", "the indentation fits nothing above it"),
    ("colon_in_text", 12, 13, "", "a second `:` on one line"),
    ("control_character", 12, 11, "", "the character U+0007 is not allowed in YAML"),
    ("date_for_text", 12, 7, "name", "expected text, found `2024-05-01`, which YAML reads as a date"),
    ("decimal_comma", 13, 14, "flight.speed_m_s", "expected a number, found the text `3,5`"),
    ("deep_nesting", 2, 26, "", "lists and mappings are nested deeper than 20"),
    ("empty", 0, 0, "", "the file is empty"),
    ("escaped_control_character", 12, 7, "name", "the text has the character U+001B, which cannot be shown"),
    ("formula_begins_with_a_bracket", 9, 12, "", "the text of `formula` begins with `[`, which YAML keeps for itself"),
    (
        "formula_begins_with_a_percent_sign",
        9,
        12,
        "",
        "the text of `formula` begins with `%`, which YAML keeps for itself",
    ),
    (
        "formula_begins_with_a_tag",
        9,
        12,
        "mission.formula",
        "the text of `formula` begins with `!`, which YAML keeps for itself",
    ),
    (
        "formula_begins_with_an_alias",
        9,
        12,
        "mission.formula",
        "the text of `formula` begins with `*`, which YAML keeps for itself",
    ),
    (
        "formula_begins_with_an_anchor",
        9,
        12,
        "mission.formula",
        "the text of `formula` begins with `&`, which YAML keeps for itself",
    ),
    ("formula_empty", 9, 12, "mission.formula", "the text is empty"),
    ("formula_in_part_in_quotes", 9, 12, "", 'the text of `formula` begins with `"`, which YAML keeps for itself'),
    ("formula_not_text", 9, 12, "mission.formula", "expected text, found `true`"),
    ("formula_syntax", 9, 22, "mission.formula", "& has no left operand (column 11)"),
    ("formula_unclosed_parenthesis", 11, 9, "mission.formula", "this parenthesis is never closed (column 13)"),
    (
        "formula_unknown_region",
        9,
        14,
        "mission.formula",
        "the formula speaks of `Feild`, which is no region (column 3)",
    ),
    ("fraction_for_whole_number", 10, 8, "mission.run", "expected a whole number, found `1.5`"),
    (
        "hexadecimal_number",
        13,
        15,
        "flight.altitude_m",
        "expected a number, found `0x1F`, which YAML does not read as a decimal number",
    ),
    ("key_that_is_a_list", 12, 3, "", "a list or mapping stands where a key must"),
    ("key_without_colon", 12, 1, "", "a key without `:`"),
    ("latitude_out_of_range", 13, 17, "origin.latitude_deg", "95.0 is more than 89.9"),
    ("many_faults", 2, 1, "nmae", "unknown key `nmae`"),
    ("many_faults", 10, 14, "mission.formula", "the formula speaks of `Feild`, which is no region (column 3)"),
    ("many_faults", 11, 9, "mission.laps", "expected until_stopped or a whole number from 1 to 10000, found `0`"),
    ("many_faults", 15, 14, "flight.speed_m_s", "expected a number, found the text `ten`"),
    ("mapping_for_number", 13, 15, "flight.altitude_m", "expected a number, found a mapping"),
    ("missing_key", 8, 1, "mission.formula", "`formula` is missing in `mission`"),
    ("missing_value", 13, 3, "flight.speed_m_s", "expected a number, found nothing"),
    (
        "heading_unknown_region",
        12,
        21,
        "flight.heading.toward",
        "the nose is to look toward `Feild`, which is no region",
    ),
    ("lanes_by_the_field", 11, 13, "flight.guidance", "lanes are flown along a trajectory, not by the field"),
    ("replan_by_the_field", 12, 11, "flight.replan", "this flight follows no trajectory whose tube it could leave"),
    ("negative_speed", 13, 14, "flight.speed_m_s", "-3 is less than 0.001"),
    ("no_frequencies", 13, 16, "smoothing.frequencies", "expected auto or a whole number from 1 to 10000, found `0`"),
    ("no_mission", 2, 1, "mission", "`mission` is missing"),
    ("no_tasks", 8, 8, "tasks", "expected at least 1 item, found 0"),
    ("not_a_mapping", 2, 1, "", "expected a mapping of keys to values, found a list"),
    ("not_utf8", 1, 50, "", "the byte 0xfc is not UTF-8"),
    (
        "number_too_large",
        13,
        15,
        "flight.altitude_m",
        "expected a number, found `1.0e+999`, which is too large for a number",
    ),
    ("number_with_unit", 13, 14, "flight.speed_m_s", "expected a number, found the text `3.5 m/s`"),
    (
        "octal_number",
        13,
        15,
        "flight.altitude_m",
        "expected a number, found `010`, which YAML does not read as a decimal number",
    ),
    ("only_comments", 0, 0, "", "the file is empty"),
    (
        "plain_text",
        1,
        1,
        "",
        "expected a mapping of keys to values, found the text `Fly to the north field and come back.`",
    ),
    ("quoted_number", 13, 14, "flight.speed_m_s", "expected a number, found the text `3.5`"),
    ("repeated_key", 11, 3, "mission.formula", "the key `formula` is repeated; it stands on line 9 already"),
    (
        "sexagesimal_number",
        13,
        17,
        "flight.final_stay_s",
        "expected a number, found `1:30`, which YAML reads as a sexagesimal number",
    ),
    ("tab_indentation", 11, 1, "", "a tab stands where YAML wants spaces"),
    ("tag", 12, 7, "name", "the tag `!!python/object/apply:os.system` is not allowed"),
    ("task_avoid_two_ends", 9, 5, "tasks[0].avoid", "until and after exclude each other"),
    ("task_avoid_without_end", 9, 5, "tasks[0].avoid", "one of until or after is missing in `tasks[0].avoid`"),
    ("task_bound_of_another_kind", 9, 25, "tasks[0].by_s", "a task of this form, `avoid`, has no `by_s`"),
    ("task_bound_of_another_kind", 10, 30, "tasks[1].within_s", "a task of this form, `visit`, has no `within_s`"),
    ("task_negative_weight", 9, 27, "tasks[0].weight", "-1 is less than 0.001"),
    ("task_not_a_mapping", 9, 5, "tasks[0]", "expected a mapping of keys to values, found the text `Home`"),
    ("task_number_for_region", 9, 12, "tasks[0].visit", "expected text or a list, found `5`"),
    ("task_of_two_kinds", 9, 5, "tasks[0]", "visit and avoid exclude each other"),
    ("task_order_of_one", 9, 20, "tasks[0].ordered_visit", "expected at least 2 items, found 1"),
    ("task_region_twice", 9, 20, "tasks[0].ordered_visit", "two of [Home, Field, Home] are the same"),
    ("task_relates_to_itself", 9, 34, "tasks[0].avoid.until", "the task relates `Home` to itself"),
    (
        "task_restricted_region",
        9,
        20,
        "tasks[0].visit[1]",
        "the task asks to enter `Keep`, which is restricted and so never entered",
    ),
    ("task_unknown_kind", 9, 5, "tasks[0].vist", "unknown key `vist`"),
    (
        "task_unknown_reaction",
        9,
        43,
        "tasks[0].react.how",
        "expected one of instantaneous, delayed, prompt, bound, bound_delay, found the text `promt`",
    ),
    ("task_unknown_region", 9, 21, "tasks[0].ordered_visit[0]", "the task speaks of `Feild`, which is no region"),
    (
        "task_visits_without_bound",
        9,
        5,
        "tasks[0].visits",
        "one of at_least, at_most or exactly is missing in `tasks[0].visits`",
    ),
    ("task_visits_zero", 9, 37, "tasks[0].visits.at_most", "0 is less than 1"),
    ("task_without_kind", 10, 5, "tasks[1]", "a task is missing here"),
    ("tasks_not_a_list", 9, 3, "tasks", "expected a list, found a mapping"),
    ("text_for_number", 13, 14, "flight.speed_m_s", "expected a number, found the text `fast`"),
    ("tilt_out_of_range", 13, 13, "limits.tilt_deg", "90 is more than 80"),
    ("time_constant_zero", 13, 20, "flight.time_constant_s", "0 is less than 0.05"),
    ("too_many_soft_tasks", 21, 27, "tasks[12].weight", "13 tasks carry a weight, more than 12"),
    ("truth_for_number", 13, 14, "flight.speed_m_s", "expected a number, found `true`"),
    ("truth_for_text", 12, 7, "name", "expected text, found `yes`, which YAML reads as true"),
    ("two_documents", 12, 1, "", "a second document begins here"),
    ("unclosed_bracket", 5, 29, "", "a list or mapping in brackets is not closed"),
    ("unclosed_quote", 12, 7, "", "a quote is never closed"),
    ("undefined_alias", 5, 29, "", "the alias *north has no anchor &north before it"),
    (
        "underscores_in_number",
        13,
        15,
        "flight.altitude_m",
        "expected a number, found `1_000`, which is no plain decimal number",
    ),
    (
        "unknown_cost",
        9,
        9,
        "search.cost",
        "expected one of transitions, distance, time, found the text `distanse`",
    ),
    (
        "unknown_cost",
        10,
        18,
        "search.suffix_weight",
        "expected decides or a whole number from 1 to 1000000, found the text `decide`",
    ),
    ("unknown_section", 12, 1, "wheather", "unknown key `wheather`"),
    (
        "unknown_laps",
        10,
        9,
        "mission.laps",
        "expected until_stopped or a whole number from 1 to 10000, found the text `until_landed`",
    ),
    ("unknown_semantics", 10, 14, "mission.semantics", "expected one of standard, paper, found the text `spot`"),
    ("window_that_ends_before", 7, 87, "regions.Keep.active_s", "180 to 60 s is no time"),
    ("yaml_bomb", 7, 32, "", "the file has more than 500000 values, aliases counted as what they repeat"),
]


@pytest.mark.parametrize("name", sorted({row[0] for row in EXPECTED}))
def test_each_fault_is_reported_where_it_stands(name: str) -> None:
    with pytest.raises(SpecError) as caught:
        load_mission(BROKEN / f"{name}.yaml")
    found = [(name, fault.line, fault.column, fault.path, fault.message) for fault in caught.value.faults]
    assert found == sorted((row for row in EXPECTED if row[0] == name), key=lambda row: row[1:])
    assert all(fault.hint for fault in caught.value.faults)
    assert caught.value.source == str(BROKEN / f"{name}.yaml")
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("name", sorted({row[0] for row in EXPECTED}))
def test_the_same_is_said_without_the_fast_parser(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(yaml_tree, "_FAST_LOADER", yaml.SafeLoader)
    test_each_fault_is_reported_where_it_stands(name)


@pytest.mark.parametrize("name", ["a_tag", "a_bracket"])
def test_a_formula_in_the_quotes_that_the_hint_asks_for_is_read(name: str) -> None:
    text = (BROKEN / f"formula_begins_with_{name}.yaml").read_text(encoding="utf-8")
    formula = re.search("formula: (.*)", text)[1]  # type: ignore[index]
    assert parse_mission(text.replace(formula, f"'{formula}'").encode()).formula == formula
    assert parse_mission(text.replace(formula, f"|\n    {formula}").encode()).formula.strip() == formula


def test_each_file_of_the_folder_has_its_expectation() -> None:
    assert sorted(path.stem for path in BROKEN.glob("*.yaml")) == sorted({row[0] for row in EXPECTED})


def test_each_other_file_of_the_folder_is_named_by_one_of_them() -> None:
    texts = [path.read_bytes() for path in BROKEN.glob("*.yaml")]
    others = [path.name for path in BROKEN.iterdir() if path.suffix != ".yaml"]
    assert all(path.endswith(".hoa") and any(path.encode() in text for text in texts) for path in others)


def test_each_file_says_what_is_wrong_with_it() -> None:
    silent = {"empty", "plain_text"}  # a comment would make another fault of them
    for path in BROKEN.glob("*.yaml"):
        assert path.stem in silent or path.read_bytes().startswith(b"# ")
