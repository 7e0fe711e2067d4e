# rayshader_pictures.R OUT: the terrains of the sheet by rayshader, seen about as in our pictures.
# rayshader turns a plot about its middle: the view has our direction and field of view, not exactly our eye.
# This script was written from rayshader's documentation and not run yet.

library(rayshader)
library(terra)
library(jsonlite)

out <- normalizePath(commandArgs(trailingOnly = TRUE)[1])
for (path in Sys.glob(file.path(out, "*", "row.json"))) {
  row <- fromJSON(path)
  folder <- dirname(path)
  if (row$kind != "terrain") {
    writeLines("not asked: no terrain", file.path(folder, "rayshader.txt"))
    next
  }
  tryCatch({
    ground <- project(rast(row$files$terrain), row$crs)
    ground <- aggregate(ground, max(1, round(max(dim(ground)) / 1000)))
    heights <- raster_to_matrix(raster::raster(ground))
    look <- row$view$forward
    picture <- sphere_shade(heights, texture = "imhof1")
    picture <- add_shadow(picture, ray_shade(heights, zscale = res(ground)[1]), 0.5)
    plot_3d(picture, heights, zscale = res(ground)[1], fov = row$view$fov_y_deg,
            theta = -atan2(look[1], look[2]) * 180 / pi, phi = -asin(look[3]) * 180 / pi,
            zoom = 0.4, windowsize = row$size)
    render_snapshot(file.path(folder, "rayshader.png"), webshot = FALSE)
    rgl::close3d()
  }, error = function(e) writeLines(paste("failed:", conditionMessage(e)), file.path(folder, "rayshader.txt")))
}
