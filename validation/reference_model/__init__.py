"""An independent reference of the model: Python and SciPy, written from the model page alone.

One module per page of the model: `units` and `scenario` read the file, `physics` holds the laws of
sections 1 to 5, `solenoid` section 6, `modes` says which branch of each law holds and when it ends,
`integration` goes through time. Bracketed numbers are equations of Colbrunn, Nelson & Quinn (2001).
"""
