import sys

import pyvista

model, picture = sys.argv[1:]
plotter = pyvista.Plotter(off_screen=True, window_size=(640, 480))
plotter.add_mesh(pyvista.read(model), smooth_shading=True)
plotter.view_xy()
plotter.screenshot(picture)
