"""A flight under a page: who commands, what flies, and what is shown of it.

The server holds the vehicles' safety, not the page: `commander` decides, is pure, and gets the time; `flight_loop`
flies by it, whatever happens to pages; `fleet` is the contract of what is flown: `simulated_fleet`, or real vehicles,
`linked_fleet`.
"""
