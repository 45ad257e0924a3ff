// Values made on the first request.

/** Promised values by key, each made once. A rejected promise is forgotten, so that the next request makes it again. */
export class Once<K, V> {
    private readonly made = new Map<K, Promise<V>>();

    get(key: K, make: () => Promise<V>): Promise<V> {
        const known = this.made.get(key);
        if (known) return known;
        const made = make();
        this.made.set(key, made);
        made.catch(() => this.made.delete(key));
        return made;
    }
}
