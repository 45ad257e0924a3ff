// Decodes half-float images encoded by crates/taotie-report/src/viewer/light.rs.

const ONE = 0x3c00;

/** The numbers of a channel: sums of the differences from the predictions by their neighbours. */
function channel(bytes: Uint8Array, from: number, [width, height]: [number, number]): Uint16Array {
    const upper = bytes.length / 2;
    const numbers = new Uint16Array(width * height);
    for (let i = 0; i < numbers.length; i++) {
        const code = bytes[from + i]! | (bytes[upper + from + i]! << 8);
        const [left, above] = [i % width > 0, i >= width];
        const expected =
            (left ? numbers[i - 1]! : 0) +
            (above ? numbers[i - width]! : 0) -
            (left && above ? numbers[i - width - 1]! : 0);
        numbers[i] = expected + ((code >>> 1) ^ -(code & 1));
    }
    return numbers;
}

/** The texels of an image: RGB with an alpha of 1. */
export function halves(bytes: Uint8Array, size: [number, number]): Uint16Array {
    const count = size[0] * size[1];
    const [green, red, blue] = [0, 1, 2].map((number) => channel(bytes, number * count, size));
    const texels = new Uint16Array(4 * count).fill(ONE);
    for (let i = 0; i < count; i++) {
        texels[4 * i] = red![i]! + green![i]!;
        texels[4 * i + 1] = green![i]!;
        texels[4 * i + 2] = blue![i]! + green![i]!;
    }
    return texels;
}
