// Lengths as text, in a suitable unit and with the significant digits.

/** A unit for lengths below a limit in metres, and its size in metres. */
interface Scale {
    below: number;
    name: string;
    size: number;
}

/** The same units as in crates/taotie-engine/src/length.rs. */
const SCALES: Scale[] = [
    { below: 1e-4, name: "µm", size: 1e-6 },
    { below: 0.1, name: "mm", size: 1e-3 },
    { below: 1, name: "cm", size: 1e-2 },
    { below: Infinity, name: "m", size: 1 },
];
const UNKNOWN: Scale = { below: Infinity, name: "model units", size: 1 };
/** The significant digits of a length without an uncertainty. */
const DIGITS = 3;

function scale(length: number, inMetres: boolean): Scale {
    if (!inMetres) return UNKNOWN;
    return SCALES.find(({ below }) => length < below) ?? UNKNOWN;
}

/** The power of ten of a number's first digit after rounding to `digits` digits. */
const place = (value: number, digits: number): number => Number(value.toExponential(digits - 1).split("e")[1]);

/** A number rounded to a power of ten. */
function rounded(value: number, power: number): string {
    if (power <= 0) return value.toFixed(Math.min(-power, 100));
    return String(Math.round(value / 10 ** power) * 10 ** power);
}

/** A length with three significant digits. */
export function lengthText(length: number, inMetres: boolean): string {
    const { name, size } = scale(length, inMetres);
    const value = length / size;
    return `${value === 0 ? "0" : rounded(value, place(value, DIGITS) - DIGITS + 1)} ${name}`;
}

/** A value with its uncertainty, which has one digit, or two if it begins with 1; the value is rounded to match. */
export function uncertain(value: number, doubt: number): string {
    if (!(doubt > 0)) return value.toPrecision(6);
    const first = place(doubt, 1);
    const power = doubt < 1.95 * 10 ** first ? first - 1 : first;
    return `${rounded(value, power)} ± ${rounded(doubt, power)}`;
}

/** A measured length and its uncertainty, both in the unit of the larger. */
export function measuredText(length: number, doubt: number, inMetres: boolean): string {
    const { name, size } = scale(Math.max(length, doubt), inMetres);
    return `${uncertain(length / size, doubt / size)} ${name}`;
}
