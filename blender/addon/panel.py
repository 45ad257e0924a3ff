"""Settings, operators and the panel in the sidebar of the 3D viewport."""

import json
import textwrap
import time
from pathlib import Path

import bpy
from bpy.props import CollectionProperty, EnumProperty, FloatVectorProperty, PointerProperty, StringProperty

from . import program, work
from .errors import remove
from .objects import parts_of
from .problem import Problem, text_of

# Seconds between looks at the running program.
STEP_S = 0.1
ICONS = {"met": "CHECKMARK", "not-met": "CANCEL", "undecided": "QUESTION"}
PIXELS_PER_LETTER = 7


def has_surface(_, thing):
    return bool(parts_of(thing))


class TaotiePreferences(bpy.types.AddonPreferences):
    """Where the program is."""

    bl_idname = __package__

    program: StringProperty(
        name="Program", subtype="FILE_PATH", description="Path of taotie; if empty, the one on PATH or in Blender's Python"
    )

    def draw(self, _):
        self.layout.prop(self, "program")


class TaotieStop(bpy.types.PropertyGroup):
    """A colour of the legend."""

    color: FloatVectorProperty(size=3, subtype="COLOR_GAMMA", min=0, max=1)


def field(name):
    return StringProperty(name=name.capitalize(), description=f"--{name} of `taotie bake`; if empty, the program's default")


class TaotieSettings(bpy.types.PropertyGroup):
    """The form, and the latest result."""

    high: PointerProperty(type=bpy.types.Object, poll=has_surface, name="High", description="The scan, with its children")
    low: PointerProperty(
        type=bpy.types.Object, poll=has_surface, name="Low", description="The low-poly object; if empty, made from the scan"
    )
    __annotations__ |= {name: field(name) for name in work.FIELDS}
    options: StringProperty(name="Options", description="Other options of the program, such as --maps normal,ao")
    output: StringProperty(
        name="Output", subtype="FILE_PATH", description="Where to write the asset (.glb), with its report next to it"
    )
    result: StringProperty(options={"HIDDEN"})
    made: PointerProperty(type=bpy.types.Collection)
    mapped: PointerProperty(type=bpy.types.Collection)
    stops: CollectionProperty(type=TaotieStop)
    show: EnumProperty(
        name="Show",
        items=[
            ("ORIGINALS", "Originals", "The picked objects"),
            ("ASSET", "Asset", "The baked asset, or the verified object"),
            ("ERROR", "Error", "The error of the normals on the surface of the asset"),
        ],
        update=lambda settings, context: show(settings, context),
    )


def show(settings, context):
    """Shows the objects of the switch and hides the others."""
    originals = [part for top in (settings.high, settings.low) if top for part in parts_of(top)]
    asset = settings.made.objects if settings.made else parts_of(settings.low) if settings.low else []
    sets = {"ORIGINALS": originals, "ASSET": list(asset), "ERROR": list(settings.mapped.objects) if settings.mapped else []}
    for thing in {thing for things in sets.values() for thing in things}:
        _set_hidden(thing, thing not in sets[settings.show])
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                _show_textures(area.spaces.active.shading, settings.show == "ERROR")


# The light and colours of the solid views, by their addresses, while the switch shows errors.
SHADINGS = {}


def _show_textures(shading, wanted):
    """Shows the colours of textures as they are in a solid view, or goes back to its own settings."""
    address = shading.as_pointer()
    if wanted:
        SHADINGS.setdefault(address, (shading.light, shading.color_type))
        shading.light, shading.color_type = "FLAT", "TEXTURE"
    elif address in SHADINGS:
        shading.light, shading.color_type = SHADINGS.pop(address)


# The object's own settings while the switch hides it.
HIDDEN = "taotie_hidden"


def _set_hidden(thing, hidden):
    if hidden and HIDDEN not in thing:
        thing[HIDDEN] = [thing.hide_viewport, thing.hide_render]
        thing.hide_viewport = thing.hide_render = True
    elif not hidden and HIDDEN in thing:
        thing.hide_viewport, thing.hide_render = (bool(was) for was in thing[HIDDEN])
        del thing[HIDDEN]


class Runs:
    """An operator that works in steps: in the background of the interface, or at once without one."""

    bl_options = {"REGISTER", "UNDO"}
    running = None

    @classmethod
    def poll(cls, context):
        return Runs.running is None and context.mode == "OBJECT"

    def invoke(self, context, _):
        if bpy.app.background or not context.window:
            return self.execute(context)
        if not self.start(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer = manager.event_timer_add(STEP_S, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        if not self.start(context):
            return {"CANCELLED"}
        while (state := self.step(context)) is None:
            time.sleep(STEP_S / 5)
        return state

    def modal(self, context, event):
        if event.type == "ESC":
            self.cancel(context)
            self.report({"INFO"}, "cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        state = self.step(context)
        if state:
            self.leave(context)
        return state or {"PASS_THROUGH"}

    def cancel(self, context):
        self.steps.close()
        self.leave(context)

    def leave(self, context):
        """Ends what the interface shows of the work."""
        Runs.running = None
        if timer := getattr(self, "timer", None):
            context.window_manager.event_timer_remove(timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        _redraw(context)

    def start(self, context):
        try:
            self.steps = self.work(context, request_of(context, self.fields, self.needs_low))
        except Problem as problem:
            self.report({"ERROR"}, str(problem))
            return False
        Runs.running = ("", 0.0)
        return True

    def step(self, context):
        """Works until the next stage or fraction; returns the operator's state at the end."""
        try:
            stage, done = Runs.running = next(self.steps)
        except StopIteration as end:
            finish(context, end.value)
            self.say(end.value)
        except Exception as problem:  # Blender's exporter and importer raise all kinds
            Runs.running = None
            self.report({"ERROR"}, text_of(problem))
            return {"CANCELLED"}
        else:
            if getattr(self, "timer", None):
                context.window_manager.progress_update(100 * done)
                context.workspace.status_text_set(f"Taotie: {stage}, {done:.0%}. Esc cancels")
                _redraw(context)
            return None
        Runs.running = None
        return {"FINISHED"}

    def say(self, outcome):
        for warning in outcome.report["warnings"]:
            self.report({"WARNING"}, warning["what"])


class TAOTIE_OT_bake(Runs, bpy.types.Operator):
    """Bake the high object to a small asset, and measure its error"""

    bl_idname, bl_label = "taotie.bake", "Bake"
    fields, needs_low, work = work.BAKE, False, staticmethod(work.bake)


class TAOTIE_OT_verify(Runs, bpy.types.Operator):
    """Measure the error of the low object, made in any way, against the high one"""

    bl_idname, bl_label = "taotie.verify", "Verify"
    fields, needs_low, work = work.VERIFY, True, staticmethod(work.verify)


def request_of(context, fields, needs_low):
    """Returns the work that the form describes."""
    settings = context.scene.taotie
    if not settings.high:
        raise Problem("pick the high-poly object first")
    if needs_low and not settings.low:
        raise Problem("pick the low-poly object to verify")
    if settings.low == settings.high:
        raise Problem(f"high and low are the same object, `{settings.high.name}`: pick two")
    output = None
    if settings.output and not needs_low:
        output = Path(bpy.path.abspath(settings.output)).resolve().with_suffix(".glb")
    command = program.command(context.preferences.addons[__package__].preferences)
    return work.Request(command, settings.high, settings.low, work.options_of(settings, fields), output)


def finish(context, outcome):
    """Puts a result into the form."""
    settings = context.scene.taotie
    settings.show = "ORIGINALS"
    _retire(settings)
    certificate = outcome.report["certificate"]
    kept = {
        "verdict": certificate["verdict"],
        "figures": outcome.figures,
        "warnings": [warning["what"] for warning in outcome.report["warnings"]],
        "page": str(outcome.page),
        "top": outcome.top,
    }
    settings.result = json.dumps(kept)
    settings.made, settings.mapped = outcome.asset, outcome.error
    settings.stops.clear()
    for stop in outcome.stops[::2]:
        settings.stops.add().color = [code / 255 for code in stop]
    settings.show = "ASSET"


def _retire(settings):
    """Removes the errors of the latest result, and hides its asset unless that was verified."""
    if settings.mapped:
        remove(settings.mapped)
    made = settings.made
    if made and settings.low not in made.objects[:]:
        made.hide_viewport = made.hide_render = True


def _redraw(context):
    for area in context.screen.areas if context.screen else []:
        if area.type == "VIEW_3D":
            area.tag_redraw()


class TAOTIE_PT_panel(bpy.types.Panel):
    """The form and the figures."""

    bl_idname, bl_label = "TAOTIE_PT_panel", "Taotie"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Taotie"

    def draw(self, context):
        settings, layout = context.scene.taotie, self.layout
        layout.use_property_split = True
        for name in ("high", "low", *work.FIELDS, "options", "output"):
            layout.prop(settings, name)
        row = layout.row()
        row.operator(TAOTIE_OT_bake.bl_idname)
        row.operator(TAOTIE_OT_verify.bl_idname)
        if Runs.running:
            stage, done = Runs.running
            layout.progress(factor=done, text=stage)
            layout.label(text="Esc cancels")
        if settings.result:
            region = context.region
            _draw_result(layout, settings, (region.width if region else 300) // PIXELS_PER_LETTER)


def _draw_result(layout, settings, letters):
    result = json.loads(settings.result)
    layout.row().prop(settings, "show", expand=True)
    if settings.show == "ERROR":
        row = layout.row(align=True)
        for stop in settings.stops:
            row.prop(stop, "color", text="")
        ends = layout.row()
        ends.label(text="0°")
        ends.label(text=f"{result['top']:g}° or more")
    layout.label(text=result["verdict"].replace("-", " ").capitalize(), icon=ICONS.get(result["verdict"], "INFO"))
    for title, text in result["figures"]:
        _draw_text(layout.box(), [title, *textwrap.wrap(text, letters)])
    for warning in result["warnings"]:
        box = layout.box()
        box.alert = True
        _draw_text(box, textwrap.wrap(warning, letters))
    if (page := Path(result["page"])).is_file():
        layout.operator("wm.url_open", text="Open the report").url = page.as_uri()


def _draw_text(box, lines):
    column = box.column(align=True)
    column.scale_y = 0.7
    for line in lines:
        column.label(text=line)


CLASSES = (TaotiePreferences, TaotieStop, TaotieSettings, TAOTIE_OT_bake, TAOTIE_OT_verify, TAOTIE_PT_panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.taotie = PointerProperty(type=TaotieSettings)


def unregister():
    del bpy.types.Scene.taotie
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
