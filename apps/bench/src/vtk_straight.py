"""Draws a straight scene by VTK as told on standard input (JSON) and prints its median processor time per frame (JSON)."""
import json
import statistics
import sys
import time

import vtk

order = json.load(sys.stdin)
if order["kind"] == "version":
    print(json.dumps({"version": vtk.vtkVersion.GetVTKVersion()}))
    sys.exit()

width, height = order["image"]
renderer = vtk.vtkRenderer()
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(width, height)
camera = renderer.GetActiveCamera()
if order["kind"] == "glb":
    window.SetMultiSamples(4)
    window.AddRenderer(renderer)
    importer = vtk.vtkGLTFImporter()
    importer.SetFileName(order["file"])
    importer.SetRenderWindow(window)
    importer.SetCamera(0)
    importer.Update()
    renderer = window.GetRenderers().GetFirstRenderer()
    camera = renderer.GetActiveCamera()
    if renderer.GetLights().GetNumberOfItems() == 0:
        renderer.CreateLight()
else:
    window.SetMultiSamples(0)
    window.AddRenderer(renderer)
    types = {"uint8": "UnsignedChar", "uint16": "UnsignedShort", "int16": "Short", "float32": "Float"}
    reader = vtk.vtkImageReader2()
    reader.SetFileName(order["file"])
    reader.SetFileDimensionality(3)
    getattr(reader, "SetDataScalarTypeTo" + types[order["dtype"]])()
    reader.SetDataByteOrderToLittleEndian()
    reader.SetDataExtent(*(v for n in order["dims"] for v in (0, n - 1)))
    reader.SetDataSpacing(*order["spacing"])
    reader.SetDataOrigin(*order["origin"])
    opacity, colors = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for value, r, g, b, alpha in order["transfer"]:
        opacity.AddPoint(value, alpha)
        colors.AddRGBPoint(value, r, g, b)
    look = vtk.vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(order["reference"])
    look.SetColor(colors)
    look.SetInterpolationTypeToLinear()
    look.SetShade(int(order["shaded"]))
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputConnection(reader.GetOutputPort())
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1.0)
    mapper.SetSampleDistance(order["step"])
    mapper.SetInteractiveSampleDistance(order["step"])
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    renderer.AddViewProp(volume)
    camera.SetPosition(*order["eye"])
    camera.SetFocalPoint(*order["target"])
    camera.SetViewUp(*order["up"])
    camera.SetViewAngle(order["fov_y_deg"])
renderer.ResetCameraClippingRange()

pixels, times = vtk.vtkUnsignedCharArray(), []
for frame in range(order["frames"] + 2):
    # A frame is drawn anew only where something moved.
    camera.Azimuth(1e-3 * (1 if frame % 2 else -1))
    renderer.ResetCameraClippingRange()
    began = time.process_time()
    window.Render()
    window.WaitForCompletion()
    window.GetPixelData(0, 0, width - 1, height - 1, 1, pixels, 0)
    times.append(1e3 * (time.process_time() - began))
if "--png" in sys.argv:
    grab, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    grab.SetInput(window)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(sys.argv[sys.argv.index("--png") + 1])
    writer.Write()
print(json.dumps({"cpu_ms": statistics.median(times[2:])}))
