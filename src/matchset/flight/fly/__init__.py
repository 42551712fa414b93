"""`matchset fly`: one flight, shown while it lasts, filmed, recorded and reported.

Read `command` and `run`. `outputs` gives each step to the view (`live_view`), the film, the recording and the report,
which `output_files` names; `log` keeps the numbers of all steps.
"""
