"""FLIP, SSIM, PSNR and RMSE of fixed pictures by their reference implementations.

Writes compare_oracle.json beside itself: `python3 tests/oracle/compare_oracle.py` (needs flip-evaluator, which is
NVIDIA's own code, and scikit-image). The pictures are made by integer arithmetic here and once more in
`crates/taotie/tests/oracle/compare.rs`; the sums of their codes show that both are the same.

    stride   of the FLIP maps' pixels every stride-th is listed
    cases    list of {name, width, height, sums of a and b, rmse, psnr (null: infinite), ssim,
             flip: list of {pixels_per_degree, mean, every}}
"""

import json
from pathlib import Path

import flip_evaluator
import numpy as np
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity

STRIDE = 97


def noise(x, y, seed):
    """0 to 31."""
    mixed = (x * 73856093 ^ y * 19349663 ^ seed * 83492791) & 0xFFFFFFFF
    return (mixed * 2654435761 & 0xFFFFFFFF) >> 27


def still_life(x, y, width, height, changed):
    """A gradient with checks, a disc and thin lines; `changed` moves, dims and tints."""
    color = [x * 255 // (width - 1), y * 255 // (height - 1), 200 if (x // 8 + y // 8) % 2 else 40]
    dx, dy = (x - 62, y - 31) if changed else (x - 60, y - 30)
    if dx * dx + dy * dy < 300:
        color = [230, 190, 60]
    if x % 16 == 3 and y > 40 and not (changed and x > 60):
        color = [20, 20, 30]
    grain = noise(x, y, 1) - 16
    if changed and x < 30 and y < 30:
        grain = noise(x, y, 2) - 16
    color = [c + grain for c in color]
    if changed:
        color = [color[0] + 5, color[1], color[2] * 9 // 10]
    return [min(max(c, 0), 255) for c in color]


def flat(color):
    return lambda x, y, w, h: color


CASES = [
    ("still life", 96, 72, lambda *a: still_life(*a, False), lambda *a: still_life(*a, True)),
    ("the same", 40, 33, lambda *a: still_life(*a, False), lambda *a: still_life(*a, False)),
    ("black and white", 24, 16, flat([0, 0, 0]), flat([255, 255, 255])),
    ("green and blue", 24, 16, flat([0, 255, 0]), flat([0, 0, 255])),
    ("noise", 64, 48, lambda x, y, w, h: [noise(x, y, s) * 8 for s in (3, 4, 5)],
     lambda x, y, w, h: [noise(x, y, s) * 8 for s in (6, 4, 5)]),
]


def picture(width, height, color):
    return np.array([[color(x, y, width, height) for x in range(width)] for y in range(height)], dtype=np.uint8)


def weighted_sum(codes):
    flat_codes = codes.reshape(-1).astype(np.uint64)
    return int(np.sum(flat_codes * (np.arange(len(flat_codes), dtype=np.uint64) % 251 + 1)))


def flip(a, b, pixels_per_degree):
    a, b = [(p / 255).astype(np.float32) for p in (a, b)]
    error, mean, _ = flip_evaluator.evaluate(a, b, "LDR", applyMagma=False, parameters={"ppd": pixels_per_degree})
    values = np.asarray(error)[..., 0].reshape(-1).astype(float)
    return {"pixels_per_degree": pixels_per_degree, "mean": float(mean), "every": values[::STRIDE].round(6).tolist()}


def case(name, width, height, first, second):
    a, b = picture(width, height, first), picture(width, height, second)
    same = np.array_equal(a, b)
    return {
        "name": name,
        "width": width,
        "height": height,
        "sums": [weighted_sum(a), weighted_sum(b)],
        "rmse": float(np.sqrt(mean_squared_error(a / 255, b / 255))),
        "psnr": None if same else float(peak_signal_noise_ratio(a, b, data_range=255)),
        "ssim": float(structural_similarity(
            a, b, channel_axis=2, data_range=255, gaussian_weights=True, sigma=1.5, use_sample_covariance=False)),
        "flip": [flip(a, b, ppd) for ppd in (67.0, 30.0, 90.0)],
    }


def main():
    path = Path(__file__).with_name("compare_oracle.json")
    path.write_text(json.dumps({"stride": STRIDE, "cases": [case(*c) for c in CASES]}))
    print(f"{path.name}: {len(CASES)} cases")


if __name__ == "__main__":
    main()
