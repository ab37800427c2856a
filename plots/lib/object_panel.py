"""Draws a panel with the hidden object of `flatspeckle image` and the points that were found."""


def draw(axis, result, found, label):
    """Draws the panel. found: (positions, brightness / mean brightness) for each frame. Returns the brightness of the
    object's points, divided by its mean."""
    brightness = result.values("object_brightness") / result.values("object_brightness").mean()
    axis.plot(result.values("object_x"), brightness, "o", markersize=9, markerfacecolor="none",
              color="0.3", label="object")
    for number, points in enumerate(found):
        axis.plot(*points, "x", color="C3", markersize=5, label=None if number else label)
    axis.set(xlabel="$x$ on the object", ylabel="brightness / mean brightness")
    return brightness
