"""FLIP, SSIM, PSNR and RMSE of fixed pictures by their reference implementations, and ΔE00 as published.

Writes compare_oracle.json beside itself: `python3 tests/oracle/compare_oracle.py` (needs flip-evaluator, which is
NVIDIA's own code, and scikit-image). The pictures are made by integer arithmetic here and once more in
`crates/taotie/tests/oracle/compare.rs`; the sums of their codes show that both are the same.

    stride   of the FLIP maps' pixels every stride-th is listed
    cases    list of {name, width, height, sums of a and b, rmse, psnr (null: infinite), ssim,
             flip: list of {pixels_per_degree, mean, every}}
    color_pairs  list of [L, a, b, L, a, b, ΔE00]
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

# Table 1 of Sharma, Wu and Dalal 2005: L*, a* and b* of two colours and their CIEDE2000, which holds both ways.
COLOR_PAIRS = [
    (50.0000, 2.6772, -79.7751, 50.0000, 0.0000, -82.7485, 2.0425),
    (50.0000, 3.1571, -77.2803, 50.0000, 0.0000, -82.7485, 2.8615),
    (50.0000, 2.8361, -74.0200, 50.0000, 0.0000, -82.7485, 3.4412),
    (50.0000, -1.3802, -84.2814, 50.0000, 0.0000, -82.7485, 1.0000),
    (50.0000, -1.1848, -84.8006, 50.0000, 0.0000, -82.7485, 1.0000),
    (50.0000, -0.9009, -85.5211, 50.0000, 0.0000, -82.7485, 1.0000),
    (50.0000, 0.0000, 0.0000, 50.0000, -1.0000, 2.0000, 2.3669),
    (50.0000, -1.0000, 2.0000, 50.0000, 0.0000, 0.0000, 2.3669),
    (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0009, 7.1792),
    (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0010, 7.1792),
    (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0011, 7.2195),
    (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0012, 7.2195),
    (50.0000, -0.0010, 2.4900, 50.0000, 0.0009, -2.4900, 4.8045),
    (50.0000, -0.0010, 2.4900, 50.0000, 0.0010, -2.4900, 4.8045),
    (50.0000, -0.0010, 2.4900, 50.0000, 0.0011, -2.4900, 4.7461),
    (50.0000, 2.5000, 0.0000, 50.0000, 0.0000, -2.5000, 4.3065),
    (50.0000, 2.5000, 0.0000, 73.0000, 25.0000, -18.0000, 27.1492),
    (50.0000, 2.5000, 0.0000, 61.0000, -5.0000, 29.0000, 22.8977),
    (50.0000, 2.5000, 0.0000, 56.0000, -27.0000, -3.0000, 31.9030),
    (50.0000, 2.5000, 0.0000, 58.0000, 24.0000, 15.0000, 19.4535),
    (50.0000, 2.5000, 0.0000, 50.0000, 3.1736, 0.5854, 1.0000),
    (50.0000, 2.5000, 0.0000, 50.0000, 3.2972, 0.0000, 1.0000),
    (50.0000, 2.5000, 0.0000, 50.0000, 1.8634, 0.5757, 1.0000),
    (50.0000, 2.5000, 0.0000, 50.0000, 3.2592, 0.3350, 1.0000),
    (60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644),
    (63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630),
    (61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731),
    (35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645),
    (22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373),
    (36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146),
    (90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441),
    (90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381),
    (6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377),
    (2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082),
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
    values = {"stride": STRIDE, "cases": [case(*c) for c in CASES], "color_pairs": COLOR_PAIRS}
    path.write_text(json.dumps(values))
    print(f"{path.name}: {len(CASES)} cases, {len(COLOR_PAIRS)} pairs of colours")


if __name__ == "__main__":
    main()
