"""VTK's physically based shading with image-based lighting; PyVista uses it too."""

import os

import answer
import numpy as np
import view
import vtkmodules.all as vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy


def body(path):
    vessel = np.load(path)
    data, points, faces = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(vessel["positions"], deep=1))
    data.SetPoints(points)
    triangles = np.pad(vessel["triangles"].astype(np.int64), ((0, 0), (1, 0)), constant_values=3)
    faces.ImportLegacyFormat(numpy_to_vtkIdTypeArray(triangles.ravel(), deep=1))
    data.SetPolys(faces)
    rows = data.GetPointData()
    tangents = vessel["tangents"][:, :3].copy()
    sets = (("Normals", vessel["normals"], rows.SetNormals), ("UV", vessel["uvs"], rows.SetTCoords))
    for name, array, put in (*sets, ("Tangents", tangents, rows.SetTangents)):
        column = numpy_to_vtk(array, deep=1)
        column.SetName(name)
        put(column)
    return data


class Vtk:
    def __init__(self, folder, mesh):
        self.folder = folder
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(body(os.path.join(folder, f"{mesh}.npz")))
        self.actor = vtk.vtkActor()
        self.actor.SetMapper(mapper)
        self.metal(self.actor.GetProperty())
        renderer = vtk.vtkOpenGLRenderer()
        renderer.AddActor(self.actor)
        renderer.SetBackground(*(code / 255 for code in view.BACKGROUND))
        self.light(renderer)
        self.look(renderer.GetActiveCamera())
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.AddRenderer(renderer)
        self.pixels = vtk.vtkUnsignedCharArray()

    def metal(self, surface):
        surface.SetInterpolationToPBR()
        surface.SetBaseColorTexture(self.map("albedo"))
        surface.SetORMTexture(self.map("orm"))
        surface.SetNormalTexture(self.map("normal"))
        surface.SetMetallic(1)
        surface.SetRoughness(1)
        surface.SetOcclusionStrength(1)
        surface.SetNormalScale(1)
        surface.BackfaceCullingOn()

    def map(self, name):
        reader, texture = vtk.vtkPNGReader(), vtk.vtkTexture()
        reader.SetFileName(os.path.join(self.folder, f"{name}.png"))
        texture.SetInputConnection(reader.GetOutputPort())
        texture.InterpolateOn()
        texture.MipmapOn()
        texture.SetUseSRGBColorSpace(name == "albedo")
        texture.SetMaximumAnisotropicFiltering(1.0)
        return texture

    def light(self, renderer):
        reader, texture = vtk.vtkHDRReader(), vtk.vtkTexture()
        reader.SetFileName(os.path.join(self.folder, "environment.hdr"))
        texture.SetColorModeToDirectScalars()
        texture.MipmapOn()
        texture.InterpolateOn()
        texture.SetInputConnection(reader.GetOutputPort())
        renderer.UseImageBasedLightingOn()
        renderer.SetEnvironmentTexture(texture, False)
        renderer.UseSphericalHarmonicsOn()
        renderer.AutomaticLightCreationOff()
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        light.PositionalOn()
        light.SetPosition(*view.LIGHT)
        light.SetFocalPoint(*view.TARGET)
        light.SetConeAngle(90)
        # Its lights have no falloff by default, and it multiplies them by pi.
        light.SetAttenuationValues(0, 0, 1)
        light.SetIntensity(view.INTENSITY / np.pi)
        renderer.AddLight(light)

    def look(self, camera):
        camera.SetPosition(*view.EYE)
        camera.SetFocalPoint(*view.TARGET)
        camera.SetViewUp(0, 1, 0)
        camera.SetViewAngle(view.FOV)
        camera.SetClippingRange(view.NEAR, view.FAR)

    def resize(self, width, height):
        self.size = (width, height)
        self.window.SetSize(width, height)

    def frame(self, angle):
        self.actor.SetOrientation(0, np.degrees(angle), 0)
        self.window.Render()
        width, height = self.size
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 1, self.pixels)

    def picture(self):
        width, height = self.size
        return vtk_to_numpy(self.pixels).reshape(height, width, 4)[::-1]

    def about(self):
        return f"VTK {vtk.vtkVersion.GetVTKVersion()}, {self.window.GetClassName()}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["ggx"])
    answer.run(args, Vtk(args.folder, args.mesh))
