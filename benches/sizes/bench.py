"""Compares the sizes and errors of assets by Taotie and other tools, each over its settings: `make bench-sizes`."""

import dataclasses
import os

import check
import command
import compare
import grids
import machine
import measure
import packs
import page
import plot
import search
import section
import store
import subjects
import tools

TARGET = "bench-sizes"
PICTURE = os.path.join(command.ROOT, "docs/images/sizes.svg")


def arguments():
    parser = command.models_parser(__doc__, TARGET)
    parser.set_defaults(page=os.path.join(command.ROOT, "docs/sizes.md"))
    parser.add_argument("--picture", help="the plot to draw, .svg or .png [default: docs/images/sizes.svg]")
    parser.add_argument("--only", nargs="+", choices=subjects.PATHS, help="only these models; prints the section only")
    parser.add_argument("--errors", nargs="+", type=float, metavar="DEG", help="values of Taotie's --error")
    parser.add_argument("--check", action="store_true", help=check.__doc__)
    args = parser.parse_args()
    command.check_program(parser, args.taotie)
    return args


def main():
    args = arguments()
    is_page_written = not (args.check or args.only)
    if is_page_written:
        page.around(args.page, TARGET)  # fails now rather than after hours
    os.makedirs(args.folder, exist_ok=True)
    models = subjects.models(args.taotie, args.data, args.folder, subjects.QUICK if args.check else args.only)
    if not models:
        raise measure.Failed(f"{args.data} contains none of the models; specify their folder with --data")
    found = [explored(model, args) for model in models]
    if args.check:
        check.run(found)
    else:
        publish(found, args, is_page_written)


def publish(found, args, is_page_written):
    """Prints the section, writes it to the page if requested, and draws the plot."""
    text = section.text(machine.described(args.taotie), tools.versions(args.node), found)
    print(text)
    picture = args.picture
    if is_page_written:
        page.write(args.page, TARGET, text)
        picture = picture or PICTURE
    if picture:
        plot.save(found, picture)


def explored(model, args):
    """The measured assets of all tools for a model."""
    installed, grid = tools.installed(args.taotie, args.node), wanted(args)
    point = store.Store(args.folder, args.taotie, model).point
    return compare.Frontiers(
        name=model.name,
        bytes=model.bytes,
        gltfpack=packs.Search(installed, model.side, point).run(grid),
        gltf_transform=search.gltf_transform(installed.gltf_transform, grid, model.side, point),
        taotie=search.taotie(installed.taotie, grid, point),
    )


def wanted(args):
    """The settings to try."""
    grid = grids.QUICK if args.check else grids.FULL
    return dataclasses.replace(grid, errors=(*args.errors, None)) if args.errors else grid


if __name__ == "__main__":
    command.run(main)
