"""Reads what the paints of wrinkles look like (paint-model/1), and tells paint from other pixels."""
import json
import sys

import numpy as np


def read(path):
    """(floor, paint id -> classifier with mark, gamma, c, score, bias, support: #S x 2, coefficients: #S)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "paint-model/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not paint-model/1")
    model, paints = artifact["data"], {}
    for paint in model["paints"]:
        support = paint.pop("support")
        paint["support"] = np.array([pixel["ratios"] for pixel in support], dtype=float).reshape(-1, 2)
        paint["coefficients"] = np.array([pixel["coefficient"] for pixel in support], dtype=float)
        paints[paint["id"]] = paint
    return model["floor"], paints


def ratios(light, floor):
    """ln(G/R), ln(B/G) of linear light: #P x 3, white is 1."""
    logs = np.log(np.asarray(light, dtype=float) + floor)
    return logs[:, 1:] - logs[:, :-1]


def decisions(paint, places):
    """Decisions, above 0 for paint, at log ratios: #P x 2."""
    squared = ((places[:, None] - paint["support"]) ** 2).sum(axis=2)
    return np.exp(-paint["gamma"] * squared) @ paint["coefficients"] + paint["bias"]


if __name__ == "__main__":
    for name, paint in read(sys.argv[1])[1].items():
        print(f"{name}: {len(paint['support'])} support pixels, tells {paint['score']:.1%} rightly")
