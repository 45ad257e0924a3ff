"""Makes small assets of six models by Taotie and by others, and measures all alike: `make bench-sizes`."""

import os

import command
import inspected
import judge
import machine
import measure
import page
import section
import subjects
import tools
from command import say

TARGET = "bench-sizes"


def arguments():
    parser = command.models_parser(__doc__, TARGET)
    parser.set_defaults(page=os.path.join(command.ROOT, "docs/sizes.md"))
    parser.add_argument("--gltfpack", help="a build of gltfpack that packs textures; npm's cannot")
    parser.add_argument("--only", nargs="+", choices=subjects.PATHS, help="these models; prints and leaves the page alone")
    args = parser.parse_args()
    command.check_program(parser, args.taotie)
    return args


def main():
    args = arguments()
    if not args.only:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    os.makedirs(args.folder, exist_ok=True)
    found = subjects.subjects(args.data, args.folder, args.only)
    if not found:
        raise measure.Failed(f"{args.data} holds none of the models; name their folder by --data")
    others = [tools.gltf_transform(args.node), tools.gltfpack(args.node, args.gltfpack)]
    results = [judged(subject, [tools.taotie(args.taotie), *others], args) for subject in found]
    text = section.text(machine.described(args.taotie), versions(args), results, judge)
    print(text)
    if not args.only:
        page.write(args.page, TARGET, text)


def judged(subject, some, args):
    """The model, its triangles, and each tool's name with its outcome."""
    eye = judge.Judge(args.taotie, args.folder, subject.path)
    return subject, eye.triangles, [(tool.name, outcome(tool, subject, eye)) for tool in some]


def outcome(tool, subject, eye):
    out = os.path.join(eye.folder, f"{subject.name}-{tool.name.split()[0]}.glb")
    job = tools.Job(subject.path, eye.triangles, out)
    try:
        for line in tool.commands(job):
            measure.run(line)
        made = {"triangles": inspected.triangles(eye.program, out), "bytes": os.path.getsize(out)}
        made["verdict"] = eye.verdict(out)
    except measure.Failed as failed:
        made = {"failed": str(failed).strip().splitlines()[-1]}
    say(f"{subject.name:12} {tool.name:24} {made}")
    return made


def versions(args):
    """Of the others, by their own words."""
    own = args.gltfpack or args.node.program("gltfpack")
    transform = measure.run([args.node.program("gltf-transform"), "--version"]).output.strip()
    return f"gltf-transform {transform}; {measure.run([own, '-v']).output.strip()}"


if __name__ == "__main__":
    command.run(main)
