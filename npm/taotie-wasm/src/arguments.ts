// Converts options to the arguments of the command.

/** The value of an option: `true` for a flag, `false` or `undefined` to leave it out, a list for comma-separated values. */
export type OptionValue = string | number | boolean | undefined | readonly (string | number)[];

/** Long options of the command by name, as in `taotie bake --help`: `{ triangles: 2000, "ray-distance": 0.02 }`. */
export type Options = Readonly<Record<string, OptionValue>>;

function argument(name: string, value: OptionValue): string[] {
    if (value === undefined || value === false) return [];
    // One word, so that a value may begin with a dash.
    return [value === true ? `--${name}` : `--${name}=${Array.isArray(value) ? value.join(",") : value}`];
}

/** Returns the arguments that stand for these options. */
export const toArguments = (options: Options): string[] =>
    Object.entries(options).flatMap(([name, value]) => argument(name, value));
