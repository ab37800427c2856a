"""A panel with the hidden object of `flatspeckle image` and what was found of it."""


def draw(axis, result, found, label):
    """found: (places, brightness over its mean) of each frame. Returns the brightness of the object's
    points over its mean."""
    brightness = result.values("object_brightness") / result.values("object_brightness").mean()
    axis.plot(result.values("object_x"), brightness, "o", markersize=9, markerfacecolor="none",
              color="0.3", label="object")
    for number, points in enumerate(found):
        axis.plot(*points, "x", color="C3", markersize=5, label=None if number else label)
    axis.set(xlabel="x of the object", ylabel="brightness over its mean")
    return brightness
