"""An independent reference of the model: Python and SciPy, written from the model page and the book alone.

One module per page: `scenario` reads the file, `physics`, `actuator`, `lines`, `valves`, `mechanism` and `control` hold
the laws, `plant` composes them into one system, `integration` goes through time. Bracketed numbers are equations of
Colbrunn, Nelson & Quinn (2001).
"""
