declare module "worker:*" {
    /** The source of the worker, bundled. */
    const source: string;
    export default source;
}
