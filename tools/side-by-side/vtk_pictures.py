#!/usr/bin/env python3
"""vtk_pictures.py OUT: town, molecule and volumes of the sheet by VTK, the renderer of ParaView.

The pictures stand for ParaView: the same filters and the same renderer, without its window."""

import json
import struct
import sys

import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rows import rows_of, target, why


def window(row):
    view = row["view"]
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0.32, 0.34, 0.43)        # ParaView's own
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*view["eye"])
    camera.SetFocalPoint(*target(view))
    camera.SetViewUp(*[-d for d in view["down"]])
    camera.SetViewAngle(view["fov_y_deg"])
    if row["kind"] != "volume":     # volumes have a light at the eye
        renderer.AutomaticLightCreationOff()
        kit = vtk.vtkLightKit()     # as ParaView's, a little brighter
        kit.SetKeyLightIntensity(1.0)
        kit.AddLightsToRenderer(renderer)
    return renderer


def save(renderer, row):
    shown = vtk.vtkRenderWindow()
    shown.SetOffScreenRendering(1)
    shown.SetMultiSamples(8)
    shown.SetSize(*row["size"])
    shown.AddRenderer(renderer)
    renderer.ResetCameraClippingRange()
    shown.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(shown)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(str(row["folder"] / "vtk.png"))
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def actor(renderer, port=None, data=None):
    mapper = vtk.vtkPolyDataMapper()
    if port is not None:
        mapper.SetInputConnection(port)
    else:
        mapper.SetInputData(data)
    made = vtk.vtkActor()
    made.SetMapper(mapper)
    renderer.AddActor(made)
    return mapper


def town(row):
    """The GLB of the straight scene: VTK reads no CityJSON."""
    reader = vtk.vtkGLTFReader()
    reader.SetFileName(row["glb"])
    reader.Update()
    joined = vtk.vtkCompositeDataGeometryFilter()
    joined.SetInputConnection(reader.GetOutputPort())
    joined.Update()
    blob = open(row["glb"], "rb").read()
    header = json.loads(blob[20:20 + struct.unpack("<I", blob[12:16])[0]])
    origin = header["scenes"][0]["extras"]["belvedere"]["origin"]
    turn = vtk.vtkTransform()
    turn.RotateX(90)
    moved = vtk.vtkTransformFilter()
    moved.SetTransform(turn)
    moved.SetInputData(joined.GetOutput())
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(moved.GetOutputPort())
    normals.ComputePointNormalsOff()
    normals.ComputeCellNormalsOn()
    normals.Update()
    ground = normals.GetOutput()
    tints = ground.GetPointData().GetArray("COLOR_0")
    if tints is not None:
        values = vtk_to_numpy(tints)[:, :3].astype(float)
        values = values / (65535.0 if values.max() > 255 else 255.0 if values.max() > 1 else 1.0)
        colors = numpy_to_vtk((255 * values ** (1 / 2.2)).astype("uint8"), deep=True)
        colors.SetName("tint")
        ground.GetPointData().SetScalars(colors)
    # The file's origin, so that coordinates are small.
    row["view"]["eye"] = [e - o for e, o in zip(row["view"]["eye"], origin)]
    renderer = window(row)
    actor(renderer, data=ground)
    # ParaView's ambient occlusion (SSAO), as its view offers it.
    occlusion = vtk.vtkSSAOPass()
    occlusion.SetRadius(12.0)
    occlusion.SetKernelSize(128)
    occlusion.BlurOn()
    steps = vtk.vtkRenderStepsPass()
    occlusion.SetDelegatePass(steps)
    renderer.SetPass(occlusion)
    save(renderer, row)


def molecule(row):
    renderer = window(row)
    reader = vtk.vtkPDBReader()
    reader.SetFileName(row["files"]["molecule"])
    ribbon = vtk.vtkProteinRibbonFilter()
    ribbon.SetInputConnection(reader.GetOutputPort())
    ribbon.SetDrawSmallMoleculesAsSpheres(False)
    actor(renderer, port=ribbon.GetOutputPort())
    # The filter draws no nucleic acids: their bonds are drawn as tubes.
    reader.Update()
    atoms = reader.GetOutput()
    chain = vtk_to_numpy(atoms.GetPointData().GetArray("chain"))
    keep = vtk.vtkIdList()
    cells = vtk.vtkCellArray()
    pair = vtk.vtkIdList()
    lines = atoms.GetLines()
    lines.InitTraversal()
    while lines.GetNextCell(pair):
        if all(chr(int(chain[pair.GetId(i)])) in "IJ" for i in range(pair.GetNumberOfIds())):
            cells.InsertNextCell(pair)
    acids = vtk.vtkPolyData()
    acids.ShallowCopy(atoms)
    acids.SetLines(cells)
    acids.SetVerts(vtk.vtkCellArray())
    tubes = vtk.vtkTubeFilter()
    tubes.SetInputData(acids)
    tubes.SetRadius(0.35)
    tubes.SetNumberOfSides(10)
    mapper = actor(renderer, port=tubes.GetOutputPort())
    mapper.SelectColorArray("rgb_colors")
    mapper.SetScalarModeToUsePointFieldData()
    save(renderer, row)


def volume(row):
    renderer = window(row)
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(row["files"]["volume"])
    opacity = vtk.vtkPiecewiseFunction()
    colors = vtk.vtkColorTransferFunction()
    if row["files"]["transfer"] == "solid":
        for value, part in ((0, 0), (70, 0), (100, 0.6), (255, 0.9)):
            opacity.AddPoint(value, part)
        for value, color in ((0, (0.5, 0.5, 0.55)), (120, (0.75, 0.76, 0.8)), (180, (0.85, 0.7, 0.5)), (255, (0.95, 0.75, 0.45))):
            colors.AddRGBPoint(value, *color)
    else:
        for value, part in ((0, 0), (140, 0), (165, 0.35), (255, 0.9)):
            opacity.AddPoint(value, part)
        for value, color in ((0, (0.3, 0.1, 0.1)), (140, (0.73, 0.25, 0.2)), (175, (0.9, 0.82, 0.65)), (255, (1, 1, 0.95))):
            colors.AddRGBPoint(value, *color)
    look = vtk.vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(colors)
    look.SetInterpolationTypeToLinear()
    look.ShadeOn()
    look.SetAmbient(0.25)
    look.SetDiffuse(0.75)
    look.SetSpecular(0.25)
    look.SetSpecularPower(20)
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()     # on the processor, so that no graphics card is needed
    mapper.SetInputConnection(reader.GetOutputPort())
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetSampleDistance(0.5)
    mapper.SetImageSampleDistance(0.5)
    shown = vtk.vtkVolume()
    shown.SetMapper(mapper)
    shown.SetProperty(look)
    renderer.AddVolume(shown)
    save(renderer, row)


DRAW = {"town": town, "molecule": molecule, "volume": volume}
for one in rows_of(sys.argv[1]):
    if one["kind"] not in DRAW:
        why(one, "vtk", "not asked: ParaView is no program for maps")
        continue
    try:
        DRAW[one["kind"]](one)
    except Exception as error:
        why(one, "vtk", f"failed: {error}")
