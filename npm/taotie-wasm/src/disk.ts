// The files of the machine for the program, through Node. (Node's own WASI corrupts its memory: version 20.)

import { Fd, wasi } from "@bjorn3/browser_wasi_shim";
import fs from "node:fs";
import path from "node:path";

/** Returns WASI's number of a system error, which has the same names. */
function numberOf(error: unknown): number {
    const code = (error as NodeJS.ErrnoException).code ?? "";
    return (wasi as unknown as Record<string, number>)[`ERRNO_${code.slice(1)}`] ?? wasi.ERRNO_IO;
}

/** Does the work and returns 0, or the number of its error. */
export function tried(work: () => void): number {
    try {
        work();
        return wasi.ERRNO_SUCCESS;
    } catch (error) {
        return numberOf(error);
    }
}

function typeOf(stats: fs.BigIntStats | fs.Dirent): number {
    if (stats.isDirectory()) return wasi.FILETYPE_DIRECTORY;
    if (stats.isFile()) return wasi.FILETYPE_REGULAR_FILE;
    if (stats.isSymbolicLink()) return wasi.FILETYPE_SYMBOLIC_LINK;
    return stats.isCharacterDevice() ? wasi.FILETYPE_CHARACTER_DEVICE : wasi.FILETYPE_UNKNOWN;
}

function statOf(stats: fs.BigIntStats): wasi.Filestat {
    const made = new wasi.Filestat(stats.ino, typeOf(stats), stats.size);
    return Object.assign(made, { dev: BigInt.asUintN(64, stats.dev), nlink: stats.nlink });
}

/** Writes all bytes, also to a pipe that is full at the moment. */
function writeAll(file: number, data: Uint8Array, position: number | null): void {
    for (let done = 0; done < data.length; ) {
        try {
            done += fs.writeSync(file, data, done, data.length - done, position === null ? null : position + done);
        } catch (error) {
            if ((error as NodeJS.ErrnoException).code !== "EAGAIN") throw error;
            Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 5);
        }
    }
}

/** An open file, or a stream of the process. */
export class DiskFile extends Fd {
    private position = 0n;

    constructor(
        private readonly file: number,
        private readonly isStream = false,
        private readonly appends = false,
    ) {
        super();
    }

    override fd_close(): number {
        return tried(() => fs.closeSync(this.file));
    }

    override fd_fdstat_get() {
        return { ret: 0, fdstat: new wasi.Fdstat(typeOf(fs.fstatSync(this.file, { bigint: true })), 0) };
    }

    override fd_filestat_get() {
        return { ret: 0, filestat: statOf(fs.fstatSync(this.file, { bigint: true })) };
    }

    override fd_filestat_set_size(size: bigint): number {
        return tried(() => fs.ftruncateSync(this.file, Number(size)));
    }

    override fd_sync(): number {
        return tried(() => fs.fsyncSync(this.file));
    }

    override fd_pread(size: number, offset: bigint | null) {
        const data = new Uint8Array(size);
        let count = 0;
        const ret = tried(() => void (count = fs.readSync(this.file, data, 0, size, offset)));
        return { ret, data: data.subarray(0, count) };
    }

    override fd_read(size: number) {
        const read = this.fd_pread(size, this.isStream ? null : this.position);
        this.position += BigInt(read.data.length);
        return read;
    }

    override fd_pwrite(data: Uint8Array, offset: bigint | null) {
        const ret = tried(() => writeAll(this.file, data, offset === null ? null : Number(offset)));
        return { ret, nwritten: ret === 0 ? data.length : 0 };
    }

    override fd_write(data: Uint8Array) {
        const written = this.fd_pwrite(data, this.isStream || this.appends ? null : this.position);
        this.position += BigInt(written.nwritten);
        return written;
    }

    override fd_seek(offset: bigint, whence: number) {
        if (this.isStream) return { ret: wasi.ERRNO_SPIPE, offset: 0n };
        const end = (): bigint => fs.fstatSync(this.file, { bigint: true }).size;
        const start = whence === wasi.WHENCE_END ? end() : whence === wasi.WHENCE_CUR ? this.position : 0n;
        if (start + offset < 0n) return { ret: wasi.ERRNO_INVAL, offset: 0n };
        this.position = start + offset;
        return { ret: 0, offset: this.position };
    }

    override fd_tell() {
        return { ret: 0, offset: this.position };
    }
}

/** Returns Node's flags for those of WASI. */
function flagsOf(oflags: number, rights: bigint, fdFlags: number): number {
    const { O_RDONLY, O_RDWR, O_WRONLY, O_CREAT, O_EXCL, O_TRUNC, O_APPEND } = fs.constants;
    const [reads, writes] = [wasi.RIGHTS_FD_READ, wasi.RIGHTS_FD_WRITE].map((right) => (rights & BigInt(right)) !== 0n);
    const pairs = [
        [oflags & wasi.OFLAGS_CREAT, O_CREAT],
        [oflags & wasi.OFLAGS_EXCL, O_EXCL],
        [oflags & wasi.OFLAGS_TRUNC, O_TRUNC],
        [fdFlags & wasi.FDFLAGS_APPEND, O_APPEND],
    ] as const;
    const access = writes ? (reads ? O_RDWR : O_WRONLY) : O_RDONLY;
    return pairs.reduce((all, [given, flag]) => (given ? all | flag : all), access);
}

/** A folder. Paths may lead out of it: the command sees all that its user does. */
export class DiskFolder extends Fd {
    private entries: fs.Dirent[] | undefined;

    constructor(
        private readonly folder: string,
        private readonly given?: string,
    ) {
        super();
    }

    /** Returns a path for the machine. */
    at(name: string): string {
        return path.resolve(this.folder, name);
    }

    override fd_prestat_get() {
        return this.given === undefined ? { ret: wasi.ERRNO_BADF, prestat: null } : { ret: 0, prestat: wasi.Prestat.dir(this.given) };
    }

    override fd_fdstat_get() {
        const fdstat = new wasi.Fdstat(wasi.FILETYPE_DIRECTORY, 0);
        return { ret: 0, fdstat: Object.assign(fdstat, { fs_rights_base: ~0n, fs_rights_inherited: ~0n }) };
    }

    override fd_filestat_get() {
        return this.path_filestat_get(0, ".");
    }

    override fd_readdir_single(cookie: bigint) {
        if (cookie === 0n) this.entries = undefined;
        const ret = tried(() => (this.entries ??= fs.readdirSync(this.folder, { withFileTypes: true })));
        const entry = this.entries?.[Number(cookie)];
        return { ret, dirent: entry ? new wasi.Dirent(cookie + 1n, 0n, entry.name, typeOf(entry)) : null };
    }

    override path_filestat_get(flags: number, name: string) {
        const follows = (flags & 1) !== 0;
        let filestat: wasi.Filestat | null = null;
        const ret = tried(() => void (filestat = statOf((follows ? fs.statSync : fs.lstatSync)(this.at(name), { bigint: true }))));
        return { ret, filestat };
    }

    override path_open(_: number, name: string, oflags: number, rights: bigint, __: bigint, fdFlags: number) {
        const target = this.at(name);
        const isFolder = fs.statSync(target, { throwIfNoEntry: false })?.isDirectory();
        if (isFolder) return { ret: 0, fd_obj: new DiskFolder(target) };
        if (oflags & wasi.OFLAGS_DIRECTORY) return { ret: isFolder === undefined ? wasi.ERRNO_NOENT : wasi.ERRNO_NOTDIR, fd_obj: null };
        let fd_obj: Fd | null = null;
        const appends = (fdFlags & wasi.FDFLAGS_APPEND) !== 0;
        const ret = tried(() => void (fd_obj = new DiskFile(fs.openSync(target, flagsOf(oflags, rights, fdFlags)), false, appends)));
        return { ret, fd_obj };
    }

    override path_readlink(name: string) {
        let data: string | null = null;
        const ret = tried(() => void (data = fs.readlinkSync(this.at(name))));
        return { ret, data };
    }

    override path_create_directory(name: string): number {
        return tried(() => fs.mkdirSync(this.at(name)));
    }

    override path_remove_directory(name: string): number {
        return tried(() => fs.rmdirSync(this.at(name)));
    }

    override path_unlink_file(name: string): number {
        return tried(() => fs.unlinkSync(this.at(name)));
    }
}
