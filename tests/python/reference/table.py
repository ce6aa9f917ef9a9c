"""Rows of a sweep beside those of the reference, in Markdown."""

COLUMNS = (
    ("felt stiffness [N/m]", "felt_stiffness_N_per_m", 0),
    ("peak force [N]", "peak_force_N", 1),
    ("force on the hand at most [N]", "peak_felt_N", 1),
    ("its largest step [N/ms]", "force_step_N_per_ms", 2),
    ("drift [mm]", "drift_mm", 2),
    ("drag [N·s/m]", "drag_N_s_per_m", 1),
    ("true energy [J]", "true_energy_J", 3),
)
MORE = {
    "four_channel": "four_channel_commanded",
    "wave": "wave_drift",
    "tdpa": "tdpa_drift",
}
"""What else of the reference stands in the row of a law."""


def cell(row: dict, key: str, digits: int) -> str:
    """A number; a dash for the stiffness of nothing, or where the task was not done."""
    value = row.get(key)
    pressed = row["done"] and row["true_stiffness_N_per_m"] > 0.0
    if value is None or (key.startswith("felt") and not pressed):
        return "–"
    # No minus before zero.
    return f"{round(value, digits) + 0.0:.{digits}f}"


def went(row: dict) -> str:
    """In a word."""
    if row["stable"]:
        return "stable"
    return "unstable" if row["swing_m"] >= 2e-3 else "not done"


def beside(ours: list[dict], theirs: list[dict]) -> str:
    """A line a case of ours without chance: ours / the paper's / with what ours adds to that."""

    def key(row: dict, law: str) -> tuple:
        return law, row["environment"], row["task"], float(row["rtt_ms"])

    known = {key(row, row["law"]): row for row in theirs}
    head = ["law", "environment", "task", "rtt [ms]", "true [N/m]", "went", *(own[0] for own in COLUMNS)]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for row in ours:
        if row["jitter_ms"] or row["loss"] or key(row, row["law"]) not in known:
            continue
        all_of = [row, known[key(row, row["law"])]]
        if (more := key(row, MORE.get(row["law"], ""))) in known:
            all_of.append(known[more])
        cells = [row["law"], row["environment"], row["task"], f"{row['rtt_ms']:.0f}"]
        cells.append(f"{row['true_stiffness_N_per_m']:.0f}")
        cells.append(" / ".join(went(own) for own in all_of))
        for _, name, digits in COLUMNS:
            cells.append(" / ".join(cell(own, name, digits) for own in all_of))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
