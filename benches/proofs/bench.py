"""Makes assets of six scans with Taotie and others, and proves them with `taotie verify`: `make proofs-table`."""

import os

import budget
import command
import machine
import measure
import page
import programs
import scans
import section
import store
from command import say
from programs import Order
from section import Row

TARGET = "proofs-table"
# Fraction of the scan's triangles, for equal triangles.
RATIO = 0.1
# Fractions of the bytes of the whole packed scan, for equal bytes; textures shrink more than geometry.
BUDGET, TEXTURED_BUDGET = 0.5, 0.25


def arguments():
    parser = command.models_parser(__doc__, TARGET)
    parser.set_defaults(page=os.path.join(command.ROOT, "docs/proofs.md"))
    parser.add_argument("--only", nargs="+", metavar="SCAN", help="only these scans; prints without writing the page")
    args = parser.parse_args()
    command.check_program(parser, args.taotie)
    return args


def main():
    args = arguments()
    if not args.only:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    os.makedirs(args.folder, exist_ok=True)
    found = scans.scans(args.data, args.folder, args.taotie)
    wanted = [scan for scan in found if not args.only or scan.name in args.only]
    if not wanted:
        raise measure.Failed(f"{args.data} contains none of the scans; specify their folder with --data")
    bench = Bench(args)
    measured = section.Measured(machine.described(args.taotie), versions(args.node), RATIO, (BUDGET, TEXTURED_BUDGET))
    text = section.text(measured, [(scan, bench.rows(scan)) for scan in wanted])
    print(text)
    if not args.only:
        page.write(args.page, TARGET, text)


class Bench:
    """Makes and proves the assets of a scan."""

    def __init__(self, args):
        self.store = store.Store(os.path.join(args.folder, "made"), args.taotie, args.node)
        self.whole = programs.whole(args.node)
        self.reducing = programs.reducing(args.node, args.taotie)

    def rows(self, scan):
        """The rows of each comparison."""
        return {"whole": self.packed(scan), "triangles": self.counted(scan), "bytes": self.fitted(scan)}

    def packed(self, scan):
        return [self.row(program, Order(scan, scan.triangles)) for program in self.whole]

    def counted(self, scan):
        order = Order(scan, round(scan.triangles * RATIO))
        return [self.row(program, order) for program in self.reducing]

    def fitted(self, scan):
        whole = self.store.asset(self.whole[0], Order(scan, scan.triangles))
        limit = whole.bytes * (TEXTURED_BUDGET if scan.is_textured else BUDGET)
        return [self.nearest(program, scan, limit) for program in self.reducing]

    def nearest(self, program, scan, limit):
        is_sided = program.has_own_maps or scan.is_textured
        try:
            order, _ = budget.fitted(lambda order: self.store.asset(program, order), scan, limit, is_sided)
        except measure.Failed as failed:
            return failure(program, scan, failed)
        return self.row(program, order)

    def row(self, program, order):
        try:
            asset = self.store.asset(program, order)
            return Row(program.name, asset, self.store.proof(asset, order.scan))
        except measure.Failed as failed:
            return failure(program, order.scan, failed)


def failure(program, scan, failed):
    say(f"{scan.name:12} {program.name:20} {failed}")
    return Row(program.name, failed=str(failed).strip().splitlines()[-1])


def versions(node):
    """The versions of the other programs, as reported by them."""
    transform = measure.run([node.program("gltf-transform"), "--version"]).output.strip()
    pack = measure.run([node.program("gltfpack"), "-v"]).output.strip()
    simplifier, blender = node.version("meshoptimizer"), programs.blender_version()
    return f"{pack}; gltf-transform {transform}; meshoptimizer {simplifier}; Blender {blender}"


if __name__ == "__main__":
    command.run(main)
