// Numbers and sentences in words.

const whole = new Intl.NumberFormat("en");

export const count = (value: number): string => whole.format(value);

/** Returns a size in bytes with three digits, such as 1.23 MB. */
export function size(bytes: number): string {
    const units = ["bytes", "kB", "MB", "GB"];
    let unit = 0;
    for (; bytes >= 1000 && unit < units.length - 1; unit++) bytes /= 1000;
    return `${unit === 0 ? bytes : Number(bytes.toPrecision(3))} ${units[unit]}`;
}

/** Returns a time that is left, in words. */
export function time(seconds: number): string {
    const rounded = Math.max(1, Math.ceil(seconds));
    if (rounded < 90) return rounded === 1 ? "1 second" : `${rounded} seconds`;
    return `${Math.round(rounded / 60)} minutes`;
}

/** Returns text with its first letter in upper case. */
export const sentence = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
